#include "coordinator/footprint_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace mvtp {
namespace {

using Corners = std::array<Point, 4>;

/// Counter-clockwise: front left, rear left, rear right, front right.
Corners corners(const Pose& rear_axle, const Vehicle& body) {
  const double half = body.width / 2.0;
  const double c = std::cos(rear_axle.theta);
  const double s = std::sin(rear_axle.theta);
  const auto at = [&](double ahead, double aside) {
    return Point{rear_axle.x + c * ahead - s * aside, rear_axle.y + s * ahead + c * aside};
  };
  return {at(body.front, half), at(-body.rear, half), at(-body.rear, -half), at(body.front, -half)};
}

/// How far all corners of `b` lie beyond the best side of `a` [m]; negative: none separates them.
double separation(const Corners& a, const Corners& b) {
  double best = -1e300;
  for (std::size_t i = 0; i < 4; ++i) {
    const Point& p = a[i];
    const Point& q = a[(i + 1) % 4];
    const double length = std::hypot(q.x - p.x, q.y - p.y);
    const Point outward{(q.y - p.y) / length, -(q.x - p.x) / length};
    double nearest = 1e300;
    for (const Point& c : b) {
      nearest = std::min(nearest, (c.x - p.x) * outward.x + (c.y - p.y) * outward.y);
    }
    best = std::max(best, nearest);
  }
  return best;
}

double distance_to_side(const Point& p, const Point& a, const Point& b) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double f =
      std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return std::hypot(p.x - a.x - f * dx, p.y - a.y - f * dy);
}

/// Two disjoint rectangles are nearest at a corner of one of them.
double corner_distance(const Corners& a, const Corners& b) {
  double nearest = 1e300;
  for (const Point& p : a) {
    for (std::size_t i = 0; i < 4; ++i) {
      nearest = std::min(nearest, distance_to_side(p, b[i], b[(i + 1) % 4]));
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

/// The least value of a function that changes by at most `slope` per unit, by bisection of all
/// intervals that could still hold a lower one.
template <class Gap>
class LeastGap {
 public:
  LeastGap(const Gap& gap, double slope, double enough)
      : gap_(gap), slope_(slope), enough_(enough) {}

  NearestMoment between(double from, double to) {
    const double last = look(to);
    if (from < to) search(from, look(from), to, last);
    return least_;
  }

 private:
  double look(double t) {
    const double gap = gap_(t);
    if (gap < least_.gap) least_ = {t, gap};
    return gap;
  }

  void search(double t0, double gap0, double t1, double gap1) {
    const double lowest = (gap0 + gap1 - slope_ * (t1 - t0)) / 2.0;
    const double accuracy = std::max(1e-4, 0.01 * std::abs(least_.gap));
    if (!(lowest < std::min(enough_, least_.gap - accuracy))) return;
    const double t = (t0 + t1) / 2.0;
    const double gap = look(t);
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
  const Corners ca = corners(a, body_a);
  const Corners cb = corners(b, body_b);
  const double gap = std::max(separation(ca, cb), separation(cb, ca));
  if (gap <= 0.0) return gap;
  return std::min(corner_distance(ca, cb), corner_distance(cb, ca));
}

StepMotion::StepMotion(const Pose& from, const Pose& to) : from_(from), to_(to) {
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
  // A twist is an arc whose tangent at the begin need not be the heading.
  const double length = t * std::hypot(along_, aside_);
  const double slip = length > 0.0 ? std::atan2(aside_, along_) : 0.0;
  const double chord_angle = slip + t * turn_ / 2.0;
  const double half = t * turn_ / 2.0;
  const double chord = std::abs(half) < 1e-6 ? length : length * std::sin(half) / half;
  return compose(from_, {chord * std::cos(chord_angle), chord * std::sin(chord_angle), t * turn_});
}

Point StepMotion::velocity(double ahead) const {
  const double c = std::cos(from_.theta);
  const double s = std::sin(from_.theta);
  const double aside = aside_ + turn_ * ahead;
  return {c * along_ - s * aside, s * along_ + c * aside};
}

NearestMoment nearest_moment(const StepMotion& a, const Vehicle& body_a, const StepMotion& b,
                             const Vehicle& body_b, double from, double enough) {
  const auto gap = [&](double t) { return clearance(a.at(t), body_a, b.at(t), body_b); };
  const double slope = closing_bound(a.velocity(middle(body_a)), a.turn(), half_diagonal(body_a),
                                     b.velocity(middle(body_b)), b.turn(), half_diagonal(body_b));
  return LeastGap(gap, slope, enough).between(from, 1.0);
}

NearestMoment nearest_moment(const StepMotion& a, const Vehicle& body, const Point& before,
                             const Pedestrian& person, double from, double enough) {
  const Point step{person.position.x - before.x, person.position.y - before.y};
  const auto gap = [&](double t) {
    return clearance(a.at(t), body, {before.x + t * step.x, before.y + t * step.y}, person.radius);
  };
  const double slope =
      closing_bound(a.velocity(middle(body)), a.turn(), half_diagonal(body), step, 0.0, 0.0);
  return LeastGap(gap, slope, enough).between(from, 1.0);
}

}  // namespace mvtp
