// The referee's separations, by FCL: the only source that includes it.

#include <fcl/narrowphase/collision.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "planner/problem/referee_geometry.hpp"

namespace mvtp::referee {
namespace {

double radius(const Box& box) { return std::hypot(box.half_length, box.half_width); }

/// The place of a body whose length points along `heading`, seen from `origin`: so far from it
/// as two bodies are from each other, doubles lose nothing.
fcl::Transform3d placed(const Point& center, const Point& heading, const Point& origin) {
  fcl::Transform3d place = fcl::Transform3d::Identity();
  place.linear() << heading.x, -heading.y, 0.0, heading.y, heading.x, 0.0, 0.0, 0.0, 1.0;
  place.translation() << center.x - origin.x, center.y - origin.y, 0.0;
  return place;
}

/// The rectangle, grown by `margin` [m] on each side, as a body so `high` that the shortest shift
/// out of it lies in the plane.
fcl::Boxd prism(const Box& box, double margin, double high) {
  return {2.0 * (box.half_length + margin), 2.0 * (box.half_width + margin), high};
}

/// How deep two bodies overlap [m]; nullopt if they do not.
std::optional<double> depth(const fcl::CollisionGeometryd& a, const fcl::Transform3d& at_a,
                            const fcl::CollisionGeometryd& b, const fcl::Transform3d& at_b) {
  fcl::CollisionRequestd request;
  request.enable_contact = true;
  request.num_max_contacts = 1;  // FCL gives the deepest one
  fcl::CollisionResultd result;
  if (fcl::collide(&a, at_a, &b, at_b, request, result) == 0) return std::nullopt;
  return result.getContact(0).penetration_depth;
}

/// A box grown by m overlaps another one by m less the gap along its own sides, and by more than
/// that less the gap along the other's: the larger of both ways round is the separation.
double separation_of_grown(const Box& a, const Box& b, double margin) {
  const double high = 4.0 * (radius(a) + radius(b) + 2.0 * margin);
  const fcl::Transform3d at_a = placed(a.center, a.heading, a.center);
  const fcl::Transform3d at_b = placed(b.center, b.heading, a.center);
  const auto of_a_grown = depth(prism(a, margin, high), at_a, prism(b, 0.0, high), at_b);
  if (!of_a_grown) return margin;
  if (margin == 0.0) return -*of_a_grown;
  const auto of_b_grown = depth(prism(a, 0.0, high), at_a, prism(b, margin, high), at_b);
  if (!of_b_grown) return margin;
  return margin - std::min(*of_a_grown, *of_b_grown);
}

}  // namespace

double separation(const Box& a, const Box& b, double enough) {
  const double between = std::hypot(b.center.x - a.center.x, b.center.y - a.center.y);
  const double of_discs = between - radius(a) - radius(b);
  if (of_discs >= enough) return of_discs;
  // Grown by the distance of their middles, any two overlap.
  return separation_of_grown(a, b, std::clamp(enough, 0.0, between));
}

double separation(const Box& box, const Circle& circle, double enough) {
  const double between = std::hypot(circle.x - box.center.x, circle.y - box.center.y);
  const double of_discs = between - radius(box) - circle.radius;
  if (of_discs >= enough) return of_discs;
  const double margin = between + radius(box);  // it overlaps the box for certain
  const fcl::Sphered grown(circle.radius + margin);
  const fcl::Transform3d place = placed({circle.x, circle.y}, {1.0, 0.0}, box.center);
  const double high = 4.0 * (margin + grown.radius);
  const auto overlap =
      depth(prism(box, 0.0, high), placed(box.center, box.heading, box.center), grown, place);
  return margin - overlap.value_or(0.0);
}

double separation(const Box& box, const Point& a, const Point& b, double enough) {
  const double length = std::hypot(b.x - a.x, b.y - a.y);
  const Point along =
      length > 0.0 ? Point{(b.x - a.x) / length, (b.y - a.y) / length} : Point{1.0, 0.0};
  const Box edge{{0.5 * (a.x + b.x), 0.5 * (a.y + b.y)}, along, 0.5 * length, 0.0};
  return separation(box, edge, enough);
}

double separation(const Box& box, const Polygon& polygon, double enough) {
  double least = contains(polygon, box.center) ? -std::min(box.half_length, box.half_width)
                                               : std::numeric_limits<double>::infinity();
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    least = std::min(least, separation(box, polygon[j], polygon[i], enough));
  }
  return least;
}

}  // namespace mvtp::referee
