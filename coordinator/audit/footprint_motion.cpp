#include "coordinator/audit/footprint_motion.hpp"

#include <algorithm>
#include <cmath>

#include "planner/problem/referee_geometry.hpp"

namespace mvtp {
namespace {

/// A footprint: its middle, the unit vector along it, and half its sides.
struct Box {
  Point middle;
  Point axis;
  double half_length;
  double half_width;
};

Box box(const Pose& rear_axle, const Vehicle& body) {
  const Point axis{std::cos(rear_axle.theta), std::sin(rear_axle.theta)};
  const double ahead = (body.front - body.rear) / 2.0;
  return {{rear_axle.x + ahead * axis.x, rear_axle.y + ahead * axis.y},
          axis,
          body.length() / 2.0,
          body.width / 2.0};
}

/// The second box as the first one sees it: its middle and the unit vector along it.
struct Seen {
  Point middle;
  Point axis;
};

Seen seen_from(const Box& a, const Box& b) {
  const double dx = b.middle.x - a.middle.x;
  const double dy = b.middle.y - a.middle.y;
  return {{dx * a.axis.x + dy * a.axis.y, dy * a.axis.x - dx * a.axis.y},
          {b.axis.x * a.axis.x + b.axis.y * a.axis.y, b.axis.y * a.axis.x - b.axis.x * a.axis.y}};
}

/// How far all of `b` lies beyond the best side of `a` [m]; negative: none separates them.
double separation(const Box& a, const Box& b, const Seen& seen) {
  const double c = std::abs(seen.axis.x);
  const double s = std::abs(seen.axis.y);
  return std::max(std::abs(seen.middle.x) - a.half_length - b.half_length * c - b.half_width * s,
                  std::abs(seen.middle.y) - a.half_width - b.half_length * s - b.half_width * c);
}

/// Squared distance of the corner of `b` that is nearest to `a`; for boxes that do not overlap.
double corner_distance_squared(const Box& a, const Box& b, const Seen& seen) {
  double nearest = 1e300;
  for (const double ahead : {b.half_length, -b.half_length}) {
    for (const double aside : {b.half_width, -b.half_width}) {
      const double x = seen.middle.x + ahead * seen.axis.x - aside * seen.axis.y;
      const double y = seen.middle.y + ahead * seen.axis.y + aside * seen.axis.x;
      const double dx = std::max(std::abs(x) - a.half_length, 0.0);
      const double dy = std::max(std::abs(y) - a.half_width, 0.0);
      nearest = std::min(nearest, dx * dx + dy * dy);
    }
  }
  return nearest;
}

double clearance(const Pose& rear_axle, const Vehicle& body, const Point& centre, double radius) {
  const Pose p = relative(rear_axle, {centre.x, centre.y, 0.0});
  const double ahead = std::max(p.x - body.front, -body.rear - p.x);
  const double aside = std::abs(p.y) - body.width / 2.0;
  const double outside = std::hypot(std::max(ahead, 0.0), std::max(aside, 0.0));
  return (outside > 0.0 ? outside : std::max(ahead, aside)) - radius;
}

/// FCL is asked where discs that cover the bodies are closer than this [m].
constexpr double kClose = 0.1;

double middle(const Vehicle& body) { return (body.front - body.rear) / 2.0; }

double half_diagonal(const Vehicle& body) { return std::hypot(body.length(), body.width) / 2.0; }

double norm(const Point& p) { return std::hypot(p.x, p.y); }

/// How much the gap between a turning body and another can change per step [m].
///
/// The signed distance of two convex bodies changes no faster than their points move, in any frame
/// that moves along. In the frame of the middle of `a`, its own points only turn about it, and
/// those of `b` turn about a middle that has the difference of the two velocities. That difference
/// turns with both, hence the third term.
double closing_bound(const Point& velocity_a, double turn_a, double radius_a,
                     const Point& velocity_b, double turn_b, double radius_b) {
  return norm({velocity_a.x - velocity_b.x, velocity_a.y - velocity_b.y}) +
         std::abs(turn_a) * radius_a + std::abs(turn_b) * radius_b +
         std::abs(turn_a - turn_b) * std::min(norm(velocity_a), norm(velocity_b));
}

double closing_bound(const StepMotion& a, const Vehicle& body_a, const StepMotion& b,
                     const Vehicle& body_b) {
  return closing_bound(a.velocity(middle(body_a)), a.turn(), half_diagonal(body_a),
                       b.velocity(middle(body_b)), b.turn(), half_diagonal(body_b));
}

/// Of a vehicle and a person who walks so far in the step.
double closing_bound(const StepMotion& a, const Vehicle& body, const Point& walk) {
  return closing_bound(a.velocity(middle(body)), a.turn(), half_diagonal(body), walk, 0.0, 0.0);
}

/// Where a person is after a share `t` of the step.
Point walked(const Point& before, const Point& walk, double t) {
  return {before.x + t * walk.x, before.y + t * walk.y};
}

/// The least value of a gap that changes by at most `slope` per unit, by bisection of all intervals
/// that could still hold a lower one. Asked as gap(t, far): where it is above `enough`, the answer
/// may be less, down to that; one of `far` or more suffices to look no closer.
template <class Gap>
class LeastGap {
 public:
  LeastGap(const Gap& gap, double slope, double enough)
      : gap_(gap), slope_(slope), enough_(enough) {}

  NearestMoment between(double from, double to) {
    const double far = enough_ + slope_ * (to - from);
    const double last = look(to, far);
    if (from < to && last < far) search(from, look(from, far), to, last);
    return least_;
  }

 private:
  double look(double t, double far) {
    const double gap = gap_(t, far);
    if (gap < least_.gap) least_ = {t, gap};
    return gap;
  }

  void search(double t0, double gap0, double t1, double gap1) {
    const double lowest = (gap0 + gap1 - slope_ * (t1 - t0)) / 2.0;
    const double accuracy = std::max(1e-4, 0.01 * std::abs(least_.gap));
    const double level = std::min(enough_, least_.gap - accuracy);
    if (!(lowest < level)) return;
    const double t = (t0 + t1) / 2.0;
    const double far = level + slope_ * (t1 - t);
    const double gap = look(t, far);
    if (gap >= far) return;
    search(t0, gap0, t, gap);
    search(t, gap, t1, gap1);
  }

  const Gap& gap_;
  double slope_;
  double enough_;
  NearestMoment least_{1.0, 1e300};
};

}  // namespace

double clearance(const Pose& a, const Vehicle& body_a, const Pose& b, const Vehicle& body_b) {
  const Box box_a = box(a, body_a);
  const Box box_b = box(b, body_b);
  const Seen from_a = seen_from(box_a, box_b);
  const Seen from_b = seen_from(box_b, box_a);
  const double gap = std::max(separation(box_a, box_b, from_a), separation(box_b, box_a, from_b));
  if (gap <= 0.0) return gap;
  // Two disjoint rectangles are nearest at a corner of one of them.
  return std::sqrt(std::min(corner_distance_squared(box_a, box_b, from_a),
                            corner_distance_squared(box_b, box_a, from_b)));
}

StepMotion::StepMotion(const Pose& from, const Pose& to)
    : from_(from), to_(to), heading_{std::cos(from.theta), std::sin(from.theta)} {
  const Pose difference = relative(from, to);
  turn_ = difference.theta;
  // The inverse of what at() does for t = 1: half the turn over its tangent, and half the turn.
  const double half = turn_ / 2.0;
  const double stretch = std::abs(half) < 1e-6 ? 1.0 : half / std::tan(half);
  along_ = stretch * difference.x + half * difference.y;
  aside_ = stretch * difference.y - half * difference.x;
}

Pose StepMotion::at(double t) const {
  if (t <= 0.0) return from_;
  if (t >= 1.0) return to_;
  const double angle = t * turn_;
  const bool straight = std::abs(angle) < 1e-6;
  const double a = straight ? t : std::sin(angle) / turn_;
  const double b = straight ? t * angle / 2.0 : (1.0 - std::cos(angle)) / turn_;
  const double x = a * along_ - b * aside_;
  const double y = b * along_ + a * aside_;
  return {from_.x + heading_.x * x - heading_.y * y, from_.y + heading_.y * x + heading_.x * y,
          wrap_to_pi(from_.theta + angle)};
}

Point StepMotion::velocity(double ahead) const {
  const double aside = aside_ + turn_ * ahead;
  return {heading_.x * along_ - heading_.y * aside, heading_.y * along_ + heading_.x * aside};
}

NearestMoment nearest_moment(const StepMotion& a, const Vehicle& body_a, const StepMotion& b,
                             const Vehicle& body_b, double from, double enough) {
  const auto gap = [&](double t, double) { return clearance(a.at(t), body_a, b.at(t), body_b); };
  return LeastGap(gap, closing_bound(a, body_a, b, body_b), enough).between(from, 1.0);
}

NearestMoment nearest_moment(const StepMotion& a, const Vehicle& body, const Point& before,
                             const Pedestrian& person, double from, double enough) {
  const Point walk{person.position.x - before.x, person.position.y - before.y};
  const auto gap = [&](double t, double) {
    return clearance(a.at(t), body, walked(before, walk, t), person.radius);
  };
  return LeastGap(gap, closing_bound(a, body, walk), enough).between(from, 1.0);
}

NearestMoment deepest_moment(const StepMotion& a, const Vehicle& body_a, const StepMotion& b,
                             const Vehicle& body_b, double from) {
  const auto gap = [&](double t, double far) {
    const referee::Box box_a = referee::footprint(body_a, a.at(t));
    const referee::Box box_b = referee::footprint(body_b, b.at(t));
    const double apart = referee::distance_of_covers(box_a, box_b);
    return apart >= kClose ? apart : referee::separation(box_a, box_b, far);
  };
  return LeastGap(gap, closing_bound(a, body_a, b, body_b), 0.0).between(from, 1.0);
}

NearestMoment deepest_moment(const StepMotion& a, const Vehicle& body, const Point& before,
                             const Pedestrian& person, double from) {
  const Point walk{person.position.x - before.x, person.position.y - before.y};
  const auto gap = [&](double t, double far) {
    const Point p = walked(before, walk, t);
    return referee::separation(referee::footprint(body, a.at(t)), Circle{p.x, p.y, person.radius},
                               far);
  };
  return LeastGap(gap, closing_bound(a, body, walk), 0.0).between(from, 1.0);
}

}  // namespace mvtp
