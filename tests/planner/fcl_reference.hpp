#pragma once

#include "planner/geometry/oriented_box.hpp"

namespace mvtp {

/// The same questions as separation(), answered by FCL for boxes and discs one metre high.
/// The distance is 0 for bodies that overlap.
[[nodiscard]] double fcl_distance(const OrientedBox& a, const OrientedBox& b);
[[nodiscard]] bool fcl_overlap(const OrientedBox& a, const OrientedBox& b);
[[nodiscard]] bool fcl_overlap(const OrientedBox& box, const Point& centre, double radius);

}  // namespace mvtp
