#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "planner/geometry/sweep.hpp"
#include "planner/problem/instance.hpp"

namespace mvtp {

/// The obstacles of a map, found by place: discs, and solid polygons, rectangles as boxes and all
/// others as their edges.
class Obstacles {
 public:
  /// @param reach  sweeps up to this radius are looked up quickly; wider ones try every obstacle
  /// [m]
  Obstacles(const Map& map, double reach);

  /// Does the moving footprint overlap an obstacle by more than kTouch?
  [[nodiscard]] bool hit(const Sweep& sweep) const;

  /// Index of an obstacle that is hit, circles first, then polygons; -1 if none.
  [[nodiscard]] int first_hit(const Sweep& sweep) const;

  /// Does it overlap an obstacle that is not among these?
  [[nodiscard]] bool hit_but(const Sweep& sweep, std::span<const int> left_out) const;
  /// The indices of all obstacles that are hit, ascending.
  [[nodiscard]] std::vector<int> all_hits(const Sweep& sweep) const;

  [[nodiscard]] bool empty() const { return circles_.empty() && parts_.empty(); }

 private:
  /// A whole rectangle, or an edge of another polygon.
  struct Part {
    OrientedBox box;
    int polygon;
  };
  /// A polygon that has edges only: whoever is inside may touch none of them.
  struct Inside {
    Polygon outline;
    int polygon;
  };

  void add(const Polygon& polygon, int index);
  [[nodiscard]] int item_count() const {
    return int(circles_.size() + parts_.size() + insides_.size());
  }
  [[nodiscard]] Extent item_extent(int item) const;
  /// @param around  the sweep's
  [[nodiscard]] bool hits_item(const Sweep& sweep, const OrientedBox& around, int item) const;
  [[nodiscard]] int obstacle_of(int item) const;
  /// Calls visitor(obstacle) for those that are hit, until it returns true. @return whether it did
  template <class Visitor>
  bool any_hit(const Sweep& sweep, Visitor&& visitor) const;

  std::vector<Circle> circles_;
  std::vector<Part> parts_;
  std::vector<Inside> insides_;

  // A grid over the map and `reach` around it; items near cell k are
  // items_[first_[k]..first_[k+1]).
  double reach_;
  double cell_size_;
  int columns_;
  int rows_;
  std::vector<int> first_;
  std::vector<int> items_;
};

}  // namespace mvtp
