#pragma once

#include <cstddef>

#include "planner/problem/instance.hpp"
#include "planner/problem/pose.hpp"

namespace mvtp {

/// Is the point inside the polygon? Points on an edge may count either way.
[[nodiscard]] inline bool contains(const Polygon& polygon, const Point& point) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Point& a = polygon[i];
    const Point& b = polygon[j];
    if ((a.y > point.y) == (b.y > point.y)) continue;
    if (point.x < a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y)) inside = !inside;
  }
  return inside;
}

}  // namespace mvtp
