#pragma once

#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "planner/geometry/moving_box.hpp"
#include "planner/lot/keep_clear.hpp"
#include "planner/motion/arc_path.hpp"
#include "planner/problem/vehicle.hpp"

namespace mvtp {

/// The ground that a car covers on its way, cell by cell of kLength metres driven: for each cell a
/// box that contains the body, grown by a margin, wherever in the cell the car is.
class PathCells {
 public:
  static constexpr double kLength = 0.2;  ///< [m]

  /// Cells in a row, both ends among them.
  struct Range {
    int first;
    int last;
  };

  PathCells() = default;
  PathCells(const ArcPath& path, const Vehicle& body, double margin);

  /// From now on the car may not wait on that ground, unless it is its goal.
  void keep_clear(const KeepClear& ground);
  [[nodiscard]] const std::vector<Range>& kept_clear() const { return kept_clear_; }
  /// The cell before which a car in cell `here` waits that may not enter `cell` yet; `here` itself
  /// if it is on ground to be kept clear already and would have to wait there: too late.
  [[nodiscard]] int waits_before(int cell, int here) const;

  /// One for each begun cell, and one for the body at rest at the end.
  [[nodiscard]] int size() const { return int(boxes_.size()); }
  /// The cell in which a car is that has driven s [m]; the last one is that of the end.
  [[nodiscard]] int cell_at(double s) const {
    return std::clamp(int(s / kLength + 1e-9), 0, size() - 1);
  }
  [[nodiscard]] const BoxPose& box(int cell) const { return boxes_[std::size_t(cell)]; }
  [[nodiscard]] const BoxShape& shape(int cell) const { return shapes_[std::size_t(cell)]; }

  /// All from this one on.
  [[nodiscard]] Range from(int first) const { return {first, size() - 1}; }
  /// All that a car uses that has driven from `s` to `stop` [m].
  [[nodiscard]] Range between(double s, double stop) const { return {cell_at(s), cell_at(stop)}; }

  /// Calls visitor(a, b) for all pairs of cells, a of this path and b of the other, that overlap.
  template <class Visitor>
  void for_each_contact(Range own, const PathCells& other, Range theirs, Visitor&& visitor) const;
  /// Does any cell of this path overlap one of the other?
  [[nodiscard]] bool touch(Range own, const PathCells& other, Range theirs) const;

 private:
  static constexpr int kBlock = 16;  ///< cells that share a circle
  struct Circle {
    float x;
    float y;
    float radius;
  };

  void add(const std::vector<Pose>& poses, const Vehicle& body, double margin);
  void bound_blocks();
  [[nodiscard]] int blocks() const { return int(circles_.size()); }

  std::vector<BoxPose> boxes_;
  std::vector<BoxShape> shapes_;
  std::vector<Circle> circles_;
  std::vector<Range> kept_clear_;  ///< ascending
};

template <class Visitor>
void PathCells::for_each_contact(Range own, const PathCells& other, Range theirs,
                                 Visitor&& visitor) const {
  const auto part_of = [](Range range, int block) {
    return Range{std::max(range.first, block * kBlock),
                 std::min(range.last, (block + 1) * kBlock - 1)};
  };
  for (int p = own.first / kBlock; p <= own.last / kBlock; ++p) {
    const Circle& circle = circles_[std::size_t(p)];
    for (int q = theirs.first / kBlock; q <= theirs.last / kBlock; ++q) {
      const Circle& other_circle = other.circles_[std::size_t(q)];
      const float reach = circle.radius + other_circle.radius;
      const float dx = circle.x - other_circle.x;
      const float dy = circle.y - other_circle.y;
      if (dx * dx + dy * dy >= reach * reach) continue;
      const Range as = part_of(own, p);
      const Range bs = part_of(theirs, q);
      for (int a = as.first; a <= as.last; ++a) {
        for (int b = bs.first; b <= bs.last; ++b) {
          if (gap(box(a), shape(a), other.box(b), other.shape(b)) < 0.0F) visitor(a, b);
        }
      }
    }
  }
}

/// How far one car may go as long as another has not come further: the arcs of a temporal plan
/// graph between the two.
///
/// Steps in ascending order of both numbers.
class Precedence {
 public:
  struct Step {
    double limit;  ///< the car that waits may drive so far [m] ...
    double need;   ///< ... until the other has driven this far [m]
  };

  void add(double limit, double need);
  /// Orders the steps and drops those that others imply.
  void finish();

  /// How far the car that waits may drive if the other has driven `s`; infinity: anywhere.
  /// @param hint  index of a step with which to begin; moves on as `s` grows
  [[nodiscard]] double limit(double s, std::size_t& hint) const {
    while (hint < steps_.size() && steps_[hint].need <= s) ++hint;
    return hint < steps_.size() ? steps_[hint].limit : std::numeric_limits<double>::infinity();
  }
  [[nodiscard]] bool empty() const { return steps_.empty(); }
  [[nodiscard]] const std::vector<Step>& steps() const { return steps_; }

 private:
  std::vector<Step> steps_;
};

/// When a car is to be in each cell of its path: what the order of passage is taken from.
struct CellSchedule {
  const PathCells* cells = nullptr;
  int first = 0;                 ///< the cell in which it is now
  std::span<const float> times;  ///< when it is in the middle of each cell [s]
};

/// The order in which two cars use the ground that both need: as planned.
/// @return  how far the first may go for the second, and the second for the first
[[nodiscard]] std::pair<Precedence, Precedence> precedence(const CellSchedule& first,
                                                           const CellSchedule& second);

}  // namespace mvtp
