#pragma once

#include <vector>

#include "planner/geometry/arc.hpp"

namespace mvtp {

/// A path of arcs, forwards and in reverse, by the distance s >= 0 driven on it [m].
class ArcPath {
 public:
  /// A stretch of one curvature and one direction.
  struct Piece {
    Arc arc;
    double begin = 0.0;  ///< s
    Pose start;

    [[nodiscard]] double end() const { return begin + std::abs(arc.length); }
    [[nodiscard]] int direction() const { return arc.length < 0.0 ? -1 : 1; }
  };

  ArcPath() = default;
  explicit ArcPath(const Pose& start) : start_(start) {}

  /// Goes on by these arcs; waits are left out, equal neighbours become one piece.
  void append(const std::vector<Arc>& arcs);
  /// Ends at s.
  void truncate(double s);

  [[nodiscard]] const Pose& start() const { return start_; }
  [[nodiscard]] const std::vector<Piece>& pieces() const { return pieces_; }
  [[nodiscard]] double length() const { return pieces_.empty() ? 0.0 : pieces_.back().end(); }
  /// The rear axle; beyond the end the car rolls straight on.
  [[nodiscard]] Pose at(double s) const;
  /// Index of the piece that is driven from s on; the last one at the end. @pre length() > 0
  [[nodiscard]] std::size_t piece_from(double s) const;
  /// Where the car stops next if nothing hinders it: at a change of direction or at the end.
  [[nodiscard]] double stop_after(double s) const;
  /// 1 forwards, -1 in reverse, 0 on a path without length.
  [[nodiscard]] int direction_from(double s) const;
  [[nodiscard]] int reversals() const;

 private:
  Pose start_;
  std::vector<Piece> pieces_;
};

}  // namespace mvtp
