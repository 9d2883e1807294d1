#pragma once

#include <cstddef>
#include <vector>

#include "planner/motion/sweep.hpp"
#include "planner/problem/instance.hpp"

namespace mvtp {

/// The obstacles of a map, found by place: discs, and solid polygons as their edges.
class Obstacles {
 public:
  /// @param reach  sweeps up to this radius are looked up quickly; wider ones try every obstacle
  /// [m]
  Obstacles(const Map& map, double reach);

  /// Does the moving footprint overlap an obstacle by more than kTouch?
  [[nodiscard]] bool hit(const Sweep& sweep) const;

  /// Index of an obstacle that is hit, circles first, then polygons; -1 if none.
  [[nodiscard]] int first_hit(const Sweep& sweep) const;

  [[nodiscard]] bool empty() const { return circles_.empty() && polygons_.empty(); }

 private:
  struct Edge {
    OrientedBox box;
    int polygon;
  };

  [[nodiscard]] int item_count() const {
    return int(circles_.size() + edges_.size() + polygons_.size());
  }
  [[nodiscard]] Extent item_extent(int item) const;
  [[nodiscard]] bool hits_item(const Sweep& sweep, int item) const;
  [[nodiscard]] int obstacle_of(int item) const;

  std::vector<Circle> circles_;
  std::vector<Edge> edges_;
  std::vector<Polygon> polygons_;

  // A grid over the map and `reach` around it; items near cell k are
  // items_[first_[k]..first_[k+1]).
  double reach_;
  double cell_size_;
  int columns_;
  int rows_;
  std::vector<int> first_;
  std::vector<int> items_;
};

/// Is the point inside the polygon? Points on an edge may count either way.
[[nodiscard]] bool contains(const Polygon& polygon, const Point& point);

}  // namespace mvtp
