#pragma once

#include <algorithm>
#include <cmath>

#include "planner/problem/pose.hpp"
#include "planner/problem/vehicle.hpp"

namespace mvtp {

/// A rectangle in the plane: centre, unit vector along its length, half its length and width [m].
///
/// Half lengths may be 0: a segment is a box without width, a point one without both.
struct OrientedBox {
  double x = 0.0;
  double y = 0.0;
  double ux = 1.0;
  double uy = 0.0;
  double half_length = 0.0;
  double half_width = 0.0;
};

/// The body of `vehicle` with its rear axle at `pose`.
[[nodiscard]] inline OrientedBox footprint(const Vehicle& vehicle, const Pose& pose) {
  const double ahead = (vehicle.front - vehicle.rear) / 2;
  const double ux = std::cos(pose.theta);
  const double uy = std::sin(pose.theta);
  return {pose.x + ahead * ux,  pose.y + ahead * uy, ux, uy,
          vehicle.length() / 2, vehicle.width / 2};
}

/// The segment from `a` to `b` as a box without width.
[[nodiscard]] inline OrientedBox segment(const Point& a, const Point& b) {
  const double length = std::hypot(b.x - a.x, b.y - a.y);
  const Point middle{(a.x + b.x) / 2, (a.y + b.y) / 2};
  if (length == 0.0) return {middle.x, middle.y, 1.0, 0.0, 0.0, 0.0};
  return {middle.x, middle.y, (b.x - a.x) / length, (b.y - a.y) / length, length / 2, 0.0};
}

/// The widest gap between two boxes along the four directions of their sides [m].
///
/// Negative if and only if their insides overlap, and then minus the depth of penetration; else at
/// most their distance, and equal to it unless two corners are closest (separating axis theorem).
/// As a lower bound it shrinks no faster than their points approach each other.
[[nodiscard]] inline double separation(const OrientedBox& a, const OrientedBox& b) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double c = std::abs(a.ux * b.ux + a.uy * b.uy);
  const double s = std::abs(a.ux * b.uy - a.uy * b.ux);
  const double along_a =
      std::abs(dx * a.ux + dy * a.uy) - a.half_length - b.half_length * c - b.half_width * s;
  const double across_a =
      std::abs(dy * a.ux - dx * a.uy) - a.half_width - b.half_length * s - b.half_width * c;
  const double along_b =
      std::abs(dx * b.ux + dy * b.uy) - b.half_length - a.half_length * c - a.half_width * s;
  const double across_b =
      std::abs(dy * b.ux - dx * b.uy) - b.half_width - a.half_length * s - a.half_width * c;
  return std::max(std::max(along_a, across_a), std::max(along_b, across_b));
}

/// The signed distance of a point from the box [m]: negative inside, minus the depth.
[[nodiscard]] inline double separation(const OrientedBox& box, const Point& point) {
  const double dx = point.x - box.x;
  const double dy = point.y - box.y;
  const double along = std::abs(dx * box.ux + dy * box.uy) - box.half_length;
  const double across = std::abs(dy * box.ux - dx * box.uy) - box.half_width;
  if (along > 0.0 && across > 0.0) return std::hypot(along, across);
  return std::max(along, across);
}

}  // namespace mvtp
