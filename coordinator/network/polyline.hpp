#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "planner/problem/pose.hpp"

namespace mvtp {

// Polylines that lanes are made of; lengths along them in metres.

[[nodiscard]] double distance(const Point& a, const Point& b);
/// The direction from `a` to `b` [rad].
[[nodiscard]] double heading(const Point& a, const Point& b);
/// The place of the segment from `a` to `b` that is nearest to `p`.
[[nodiscard]] Point nearest(const Point& p, const Point& a, const Point& b);
[[nodiscard]] double length_of(std::span<const Point> line);
[[nodiscard]] Point point_at(std::span<const Point> line, double s);
[[nodiscard]] double distance_to(std::span<const Point> line, const Pose& place);
/// The line from `from` to `to` [m] along another, both within its length.
[[nodiscard]] std::vector<Point> stretch_of(std::span<const Point> line, double from, double to);
/// The line without its first `length` metres; continued straight backwards if that is negative.
[[nodiscard]] std::vector<Point> trimmed(std::vector<Point> line, double length);
/// The line without its last `length` metres.
[[nodiscard]] std::vector<Point> shortened(std::vector<Point> line, double length);

/// A centre line in parts: between two of them it jumps sideways, from one lane to another.
struct BrokenLine {
  struct Jump {
    std::size_t first = 0;  ///< point behind it
    double left = 0.0;      ///< [m] to the left
    double begin = 0.0;     ///< [m] along the line: over this stretch the jump is to be spread out
    double end = 0.0;
  };
  std::vector<Point> points;
  std::vector<Jump> jumps;
  double length = 0.0;  ///< [m] without the jumps

  /// Appends points without repeating any.
  void append(std::span<const Point> more);
};

/// The line with its jumps spread out: before each it leans towards where it jumps to, behind it
/// comes from where it jumped from.
[[nodiscard]] std::vector<Point> without_jumps(const BrokenLine& line);

}  // namespace mvtp
