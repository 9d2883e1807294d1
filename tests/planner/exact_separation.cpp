#include "tests/planner/exact_separation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace mvtp::referee {
namespace {

Point minus(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y}; }
double dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y; }
/// Turned by a right angle to the left.
Point left(const Point& a) { return {-a.y, a.x}; }

/// Half the extent of the box along the unit vector n.
double half_extent(const Box& box, const Point& n) {
  return box.half_length * std::abs(dot(box.heading, n)) +
         box.half_width * std::abs(dot(left(box.heading), n));
}

/// `p` in the frame of the box.
Point local(const Box& box, const Point& p) {
  const Point d = minus(p, box.center);
  return {dot(d, box.heading), dot(d, left(box.heading))};
}

/// The corners, in order.
std::array<Point, 4> corners(const Box& box) {
  std::array<Point, 4> result;
  const Point aside = left(box.heading);
  const std::array<Point, 4> signs = {{{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};
  for (std::size_t k = 0; k < 4; ++k) {
    const double ahead = signs[k].x * box.half_length;
    const double across = signs[k].y * box.half_width;
    result[k] = {box.center.x + ahead * box.heading.x + across * aside.x,
                 box.center.y + ahead * box.heading.y + across * aside.y};
  }
  return result;
}

double distance_from(const Box& box, const Point& point) {
  const Point p = local(box, point);
  return std::hypot(std::max(std::abs(p.x) - box.half_length, 0.0),
                    std::max(std::abs(p.y) - box.half_width, 0.0));
}

}  // namespace

// Of two convex polygons that overlap, the shortest shift that ends it is along a normal of one of
// their sides; of two that do not, the gap along any direction is at most their distance.
double exact_separation(const Box& a, const Box& b) {
  const Point d = minus(b.center, a.center);
  double widest = -std::numeric_limits<double>::infinity();
  for (const Point& n : {a.heading, left(a.heading), b.heading, left(b.heading)}) {
    widest = std::max(widest, std::abs(dot(d, n)) - half_extent(a, n) - half_extent(b, n));
  }
  return widest;
}

double exact_separation(const Box& box, const Circle& circle) {
  const Point center = local(box, {circle.x, circle.y});
  const double dx = std::abs(center.x) - box.half_length;
  const double dy = std::abs(center.y) - box.half_width;
  const double outside = std::hypot(std::max(dx, 0.0), std::max(dy, 0.0));
  return outside + std::min(std::max(dx, dy), 0.0) - circle.radius;
}

double exact_separation(const Box& box, const Point& a, const Point& b) {
  const Point p = local(box, a);
  const Point q = local(box, b);
  const auto gap = [](double u, double v, double half) {
    return std::max(std::min(u, v) - half, -std::max(u, v) - half);
  };
  const double along = gap(p.x, q.x, box.half_length);
  const double aside = gap(p.y, q.y, box.half_width);
  const Point normal = left(minus(q, p));
  const double length = std::hypot(normal.x, normal.y);
  const double across = (std::abs(dot(p, normal)) - box.half_length * std::abs(normal.x) -
                         box.half_width * std::abs(normal.y)) /
                        length;
  return std::max({along, aside, across});
}

// Two disjoint rectangles are nearest at a corner of one of them.
double exact_distance(const Box& a, const Box& b) {
  if (exact_separation(a, b) <= 0.0) return 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (const Point& p : corners(a)) least = std::min(least, distance_from(b, p));
  for (const Point& p : corners(b)) least = std::min(least, distance_from(a, p));
  return least;
}

}  // namespace mvtp::referee
