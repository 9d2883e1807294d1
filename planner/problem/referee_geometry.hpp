#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "planner/problem/instance.hpp"

/// The referee's own geometry. Nothing that plans may use it, and it uses nothing of theirs: an
/// error in one of the two then shows as a disagreement. Hence the namespace, against the flat
/// rule.
namespace mvtp::referee {

/// A rectangle: its centre, the unit vector of its heading, and half its length and width [m].
struct Box {
  Point center;
  Point heading{1.0, 0.0};
  double half_length = 0.0;
  double half_width = 0.0;
};

/// The footprint of a vehicle whose rear axle is at `pose`.
[[nodiscard]] Box footprint(const Vehicle& vehicle, const Pose& pose);

/// The largest distance of a point of the footprint from the rear axle [m].
[[nodiscard]] double reach(const Vehicle& vehicle);

/// What is asked of a separation by default: its exact value.
inline constexpr double kExact = std::numeric_limits<double>::infinity();

// Separations [m]. Negative: minus the depth of the overlap, the length of the shortest shift that
// ends it. Positive: the widest gap along a side of one of the two, at most their distance. All
// change by at most d when a point of the one shape moves by at most d against the other (each is a
// maximum over directions n of the gap along n).
//
// Who only wants to know whether they are `enough` [m] apart gets it cheaper: where they are, the
// result is any number from `enough` up to their distance.
//
// FCL decides, by its closed forms for boxes and spheres: exact to rounding, where its distances
// by GJK are not (docs/experiments/planner.md, "The referee's geometry").

[[nodiscard]] double separation(const Box& a, const Box& b, double enough = kExact);
[[nodiscard]] double separation(const Box& box, const Circle& circle, double enough = kExact);
/// From the segment between `a` and `b`, an edge of a polygon.
[[nodiscard]] double separation(const Box& box, const Point& a, const Point& b,
                                double enough = kExact);
/// From a solid polygon: the least separation from its edges, or, for a box inside that touches
/// none, minus half its shorter side. Where a corner of the box meets a wall drawn as many short
/// edges, the depth comes out up to sqrt(2) too small; elsewhere it is exact.
[[nodiscard]] double separation(const Box& box, const Polygon& polygon, double enough = kExact);

/// At most the distance of the two boxes [m], at little cost: the distance of discs that cover
/// them, in a row each. Negative where discs overlap.
[[nodiscard]] double distance_of_covers(const Box& a, const Box& b);

/// A disc that covers a footprint, at rest or during a motion.
struct Disc {
  Point center;
  double radius = 0.0;
};

[[nodiscard]] inline bool overlap(const Disc& a, const Disc& b) {
  const double dx = a.center.x - b.center.x;
  const double dy = a.center.y - b.center.y;
  const double reach = a.radius + b.radius;
  return dx * dx + dy * dy <= reach * reach;
}

/// All (i, j), i < j, whose discs overlap. Sweeps along x: only discs that overlap in x are
/// compared.
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> near_pairs(
    const std::vector<Disc>& discs);

/// Discs that lie still, found by place: sorted along x.
class DiscsByX {
 public:
  DiscsByX() = default;
  explicit DiscsByX(std::vector<Disc> discs);

  /// The indices of those that overlap the given one, ascending; valid until the next call.
  [[nodiscard]] const std::vector<std::size_t>& near(const Disc& disc);

 private:
  std::vector<Disc> discs_;
  std::vector<std::pair<double, std::size_t>> order_;  ///< by the x of their centres
  double largest_ = 0.0;
  std::vector<std::size_t> near_;
};

/// Discs around all obstacles of the map: circles first, then polygons.
[[nodiscard]] DiscsByX discs_of_obstacles(const Map& map);

/// The least distance of a point of the box from the border of the map, inside; negative outside.
[[nodiscard]] double margin_inside(const Map& map, const Box& box);
[[nodiscard]] double margin_inside(const Map& map, const Point& point);

/// Even-odd rule; points on the outline may go either way.
[[nodiscard]] bool contains(const Polygon& polygon, const Point& point);

/// The motion of a rear axle during one step, s in [0, 1]: an arc of signed `length` and
/// `curvature`, plus a share s of `drift`, the small rest that joins the arc's end to the pose in
/// the plan. A motion along a straight line of poses is all drift.
struct Motion {
  Pose from;
  double length = 0.0;
  double curvature = 0.0;
  Pose drift;

  [[nodiscard]] Pose at(double s) const {
    const Pose arc = drive(from, s * length, curvature);
    return {arc.x + s * drift.x, arc.y + s * drift.y, arc.theta + s * drift.theta};
  }

  /// An upper bound on the speed [m per step] of any point within `radius` of the rear axle: the
  /// axle moves at |length| + |drift|, the body turns at |length * curvature| + |drift angle|.
  [[nodiscard]] double speed_bound(double radius) const {
    const double turn = std::abs(length * curvature) + std::abs(drift.theta);
    return std::abs(length) + std::hypot(drift.x, drift.y) + turn * radius;
  }
};

/// The arc that joins two poses, by the chord's length and half the change of heading.
struct Arc {
  double length = 0.0;
  double curvature = 0.0;
};
[[nodiscard]] Arc joining_arc(const Pose& from, const Pose& to);

/// The earliest s in [0, 1] found with f(s) < level, given that |f(a) - f(b)| <= rate * |a - b|.
/// Asked as f(s, enough): where f(s) >= enough, the answer may be any number from `enough` to f(s).
///
/// Intervals are halved until f at their middle proves them clear. Complete up to `kResolution`: if
/// none is found, f >= level - kResolution everywhere; if one is found, f is below `level` there.
inline constexpr double kResolution = 1e-5;

template <class F>
[[nodiscard]] std::optional<double> first_below(const F& f, double level, double rate,
                                                double begin = 0.0, double end = 1.0) {
  const double middle = 0.5 * (begin + end);
  const double change = 0.5 * (end - begin) * rate;
  const double enough = level + change;
  const double value = f(middle, enough);
  if (value >= enough) return std::nullopt;
  if (change < kResolution) return value < level ? std::optional(middle) : std::nullopt;
  if (const auto early = first_below(f, level, rate, begin, middle)) return early;
  if (value < level) return middle;
  return first_below(f, level, rate, middle, end);
}

}  // namespace mvtp::referee
