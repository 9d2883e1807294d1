#pragma once

#include <memory>
#include <vector>

#include "planner/motion/arc.hpp"

namespace mvtp {

/// Shortest paths of a car without obstacles that drives forwards and in reverse.
///
/// Source: Reeds & Shepp 1990, as implemented by OMPL. One object per thread: it keeps scratch
/// space.
class ReedsShepp {
 public:
  ReedsShepp();
  ~ReedsShepp();
  ReedsShepp(ReedsShepp&&) noexcept;
  ReedsShepp& operator=(ReedsShepp&&) noexcept;

  /// Length of the shortest path [m]. @pre radius > 0 [m], the smallest turning radius.
  [[nodiscard]] double length(const Pose& from, const Pose& to, double radius) const;

  /// The shortest path as at most five arcs; empty if from == to. It ends at `to` within 1e-5 m and
  /// rad for distances up to some hundred radii.
  [[nodiscard]] std::vector<Arc> path(const Pose& from, const Pose& to, double radius) const;

 private:
  struct Space;
  std::unique_ptr<Space> space_;
};

/// Lengths of Reeds-Shepp paths over relative poses, by interpolation: some ten nanoseconds each.
///
/// For the heuristics of searches: about right (mean error 0.01, largest 0.4 radii) but no bound.
/// Entries are computed when first asked for, so one object per thread.
class ReedsSheppTable {
 public:
  ReedsSheppTable();

  /// Length of the path between the origin and (x, y, theta) for radius 1, either way.
  [[nodiscard]] double length(double x, double y, double theta) const;

 private:
  [[nodiscard]] double inside(double x, double y, double theta) const;
  [[nodiscard]] double entry(int x, int y, int heading) const;

  ReedsShepp curves_;
  mutable std::vector<float> lengths_;  ///< negative: not computed yet
};

}  // namespace mvtp
