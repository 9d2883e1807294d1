#include "traci_bridge/parking_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "planner/geometry.hpp"

namespace mvtp {
namespace {

constexpr double kOnItsWay = 1e-6;  // of a segment, until it has left a border that it begins on

std::size_t next(const Polygon& polygon, std::size_t i) { return (i + 1) % polygon.size(); }

OrientedBox edge(const Polygon& polygon, std::size_t i) {
  return segment(polygon[i], polygon[next(polygon, i)]);
}

OrientedBox point(const Point& p) { return {p.x, p.y, 1.0, 0.0, 0.0, 0.0}; }

bool strictly_inside(const Polygon& polygon, const Point& p) {
  return contains(polygon, p) && gap(point(p), polygon) > kTolerance;
}

/// A point inside the polygon, close to the middle of a side.
Point beside(const Polygon& polygon, std::size_t i) {
  const OrientedBox side = edge(polygon, i);
  const Point left{side.x - 2 * kTolerance * side.uy, side.y + 2 * kTolerance * side.ux};
  const Point right{side.x + 2 * kTolerance * side.uy, side.y - 2 * kTolerance * side.ux};
  return contains(polygon, left) ? left : right;
}

/// How far along the segment from `a` to `b`, in (0, 1], it first meets the outline; none: never.
std::optional<double> first_crossing(const Point& a, const Point& b, const Polygon& polygon) {
  std::optional<double> first;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point& p = polygon[i];
    const Point& q = polygon[next(polygon, i)];
    const double across = (b.x - a.x) * (q.y - p.y) - (b.y - a.y) * (q.x - p.x);
    if (across == 0.0) continue;  // parallel
    const double along = ((p.x - a.x) * (q.y - p.y) - (p.y - a.y) * (q.x - p.x)) / across;
    const double on_side = ((p.x - a.x) * (b.y - a.y) - (p.y - a.y) * (b.x - a.x)) / across;
    const bool meets = along > kOnItsWay && along <= 1.0 && on_side >= 0.0 && on_side <= 1.0;
    if (meets && (!first || along < *first)) first = along;
  }
  return first;
}

double distance(const Point& a, const Point& b) { return std::hypot(b.x - a.x, b.y - a.y); }

}  // namespace

double gap(const OrientedBox& box, const Polygon& polygon) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    least = std::min(least, separation(box, edge(polygon, i)));
  }
  return least;
}

bool overlap(const Polygon& a, const Polygon& b) {
  const auto enters = [](const Polygon& one, const Polygon& other) {
    for (std::size_t i = 0; i < one.size(); ++i) {
      if (strictly_inside(other, one[i]) || strictly_inside(other, beside(one, i))) return true;
      if (gap(edge(one, i), other) < -kTolerance) return true;
    }
    return false;
  };
  return enters(a, b) || enters(b, a);
}

OrientedBox inner_box(const ParkingSlot& slot) {
  return {slot.middle.x,
          slot.middle.y,
          std::cos(slot.middle.theta),
          std::sin(slot.middle.theta),
          slot.length / 2 - kTolerance,
          slot.width / 2 - kTolerance};
}

bool covers(const Polygon& polygon, const OrientedBox& box) {
  return contains(polygon, {box.x, box.y}) || gap(box, polygon) < 0.0;
}

bool inside(const OrientedBox& box, const Polygon& polygon) {
  return contains(polygon, {box.x, box.y}) && gap(box, polygon) >= 0.0;
}

std::optional<std::pair<std::size_t, std::size_t>> self_contact(const Polygon& polygon) {
  constexpr double kApart = 1e-6;
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      double apart = 0.0;
      if (j == next(polygon, i)) {
        apart = std::min(separation(point(polygon[next(polygon, j)]), edge(polygon, i)),
                         separation(point(polygon[i]), edge(polygon, j)));
      } else if (i == next(polygon, j)) {
        apart = std::min(separation(point(polygon[next(polygon, i)]), edge(polygon, j)),
                         separation(point(polygon[j]), edge(polygon, i)));
      } else {
        apart = separation(edge(polygon, i), edge(polygon, j));
      }
      if (apart <= kApart) return std::pair(i, j);
    }
  }
  return std::nullopt;
}

double length_of(const std::vector<Point>& line) {
  double length = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) length += distance(line[i - 1], line[i]);
  return length;
}

Piece piece_on_ground(const std::vector<Point>& line, const Polygon& ground) {
  Piece piece{.line = {line.front()}};
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Point& a = line[i - 1];
    const Point& b = line[i];
    const Point ahead{a.x + (b.x - a.x) * kOnItsWay, a.y + (b.y - a.y) * kOnItsWay};
    const std::optional<double> crossing =
        contains(ground, ahead) ? first_crossing(a, b, ground) : std::optional(0.0);
    const double share = crossing.value_or(1.0);
    piece.line.push_back({a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)});
    piece.leaves = crossing.has_value() && (i + 1 < line.size() || share < 1.0);
    if (crossing) break;
  }
  return piece;
}

double bend(const std::vector<Point>& line) {
  const OrientedBox chord = segment(line.front(), line.back());
  double farthest = 0.0;
  for (const Point& p : line) {
    const double aside = (p.y - chord.y) * chord.ux - (p.x - chord.x) * chord.uy;
    farthest = std::max(farthest, std::abs(aside));
  }
  return farthest;
}

}  // namespace mvtp
