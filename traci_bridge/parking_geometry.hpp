#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "planner/geometry.hpp"
#include "planner/problem/instance.hpp"
#include "planner/problem/parking_lot.hpp"

namespace mvtp {

// Polygons, slots and lines as they are drawn in a file, in metres.

inline constexpr double kTolerance = 0.05;  ///< of what touches, or is straight [m]

/// The gap between a shape and the outline of a polygon [m], <= 0 where they meet.
[[nodiscard]] double gap(const OrientedBox& box, const Polygon& polygon);
/// Do two polygons share more than borders?
[[nodiscard]] bool overlap(const Polygon& a, const Polygon& b);
/// The slot's rectangle, smaller by the tolerance on every side.
[[nodiscard]] OrientedBox inner_box(const ParkingSlot& slot);
/// Does the polygon share ground with the box?
[[nodiscard]] bool covers(const Polygon& polygon, const OrientedBox& box);
[[nodiscard]] bool inside(const OrientedBox& box, const Polygon& polygon);
/// Where a polygon is not simple: the first two sides that meet, or fold back on each other.
[[nodiscard]] std::optional<std::pair<std::size_t, std::size_t>> self_contact(
    const Polygon& polygon);

[[nodiscard]] double length_of(const std::vector<Point>& line);
/// The farthest that a line is from the straight line between its ends [m].
[[nodiscard]] double bend(const std::vector<Point>& line);

/// A line from a point on the ground as far as it stays there.
struct Piece {
  std::vector<Point> line;
  bool leaves = false;  ///< the ground before its end
};
[[nodiscard]] Piece piece_on_ground(const std::vector<Point>& line, const Polygon& ground);

}  // namespace mvtp
