#include "planner/geometry/sweep.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace mvtp {
namespace {

/// sin(a), cos(a), and (1 - cos(a)) / a and sin(a) / a without cancellation.
struct Trig {
  double sin;
  double cos;
  double sinc;
  double cosc;
};

/// first * (1 - q r0 (1 - q r1 (1 - q r2 ...)))
constexpr double series(double q, double first, const std::array<double, 7>& ratios) {
  double sum = 1.0;
  for (std::size_t k = ratios.size(); k-- > 0;) sum = 1.0 - q * ratios[k] * sum;
  return first * sum;
}

/// By Taylor series up to 1.2 rad (error < 1e-13), more than a car turns in one step; a few
/// multiplications, and the same digits with every C library.
Trig trig(double a) {
  if (a == 0.0) return {0.0, 1.0, 1.0, 0.0};  // the time step most pairs are told apart at
  if (std::abs(a) > 1.2) {
    const double s = std::sin(a);
    const double c = std::cos(a);
    return {s, c, s / a, (1.0 - c) / a};
  }
  const double q = a * a;
  // sin(a)/a = 1 - q/3! + q^2/5! - ...;  (1 - cos(a))/q = 1/2! - q/4! + q^2/6! - ...
  // Factors, not divisors: divisions take longer.
  const double sinc =
      series(q, 1.0, {1. / 6, 1. / 20, 1. / 42, 1. / 72, 1. / 110, 1. / 156, 1. / 210});
  const double versine =
      series(q, 0.5, {1. / 12, 1. / 30, 1. / 56, 1. / 90, 1. / 132, 1. / 182, 1. / 240});
  return {a * sinc, 1.0 - q * versine, sinc, a * versine};
}

/// Is `gap` kept above -1.5 kTouch by a body that travels at most `travel` per unit of s?
///
/// `gap_at(s)` may be any function that falls no faster than `travel` and is negative exactly when
/// the bodies overlap.
template <class Gap>
bool stays_clear(const Gap& gap_at, double travel) {
  struct Interval {
    double s0, gap0, s1, gap1;
  };
  // Depth first, so the stack holds one interval per halving; 40 halvings of any travel suffice.
  std::array<Interval, 48> stack;
  std::size_t size = 0;

  const double gap0 = gap_at(0.0);
  if (gap0 < -kTouch) return false;
  // Everything within reach of the first gap alone: most pairs end here.
  if (gap0 - travel > 0.0) return true;
  const double gap1 = gap_at(1.0);
  if (gap1 < -kTouch) return false;
  stack[size++] = {0.0, gap0, 1.0, gap1};
  while (size > 0) {
    const Interval i = stack[--size];
    if (i.gap0 + i.gap1 - travel * (i.s1 - i.s0) >= -3.0 * kTouch || size + 2 > stack.size()) {
      continue;
    }
    const double s = (i.s0 + i.s1) / 2;
    const double gap = gap_at(s);
    if (gap < -kTouch) return false;
    stack[size++] = {i.s0, i.gap0, s, gap};
    stack[size++] = {s, gap, i.s1, i.gap1};
  }
  return true;
}

bool circles_apart(const Sweep& a, const Point& centre, double radius) {
  const double dx = a.centre().x - centre.x;
  const double dy = a.centre().y - centre.y;
  const double reach = a.radius() + radius;
  return dx * dx + dy * dy > reach * reach;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Extent kNothing{kInfinity, kInfinity, -kInfinity, -kInfinity};

void include(Extent& extent, double x, double y) {
  extent.min_x = std::min(extent.min_x, x);
  extent.min_y = std::min(extent.min_y, y);
  extent.max_x = std::max(extent.max_x, x);
  extent.max_y = std::max(extent.max_y, y);
}

/// Widens `extent` by the way of the point (ahead, left) of a car's frame.
void include_path_of_point(Extent& extent, const Pose& from, const Arc& arc, double ahead,
                           double left) {
  const Pose start = compose(from, {ahead, left, 0.0});
  const Pose end = compose(drive(from, arc), {ahead, left, 0.0});
  include(extent, start.x, start.y);
  include(extent, end.x, end.y);
  const double turn = arc.length * arc.curvature;
  if (turn == 0.0) return;

  // The point circles the turning centre; it may pass the circle's extreme points on its way.
  const Pose pivot = compose(from, {0.0, 1.0 / arc.curvature, 0.0});
  const double radius = std::hypot(start.x - pivot.x, start.y - pivot.y);
  const double angle = std::atan2(start.y - pivot.y, start.x - pivot.x);
  const double first = std::min(angle, angle + turn);
  const double last = std::max(angle, angle + turn);
  constexpr double kQuarter = std::numbers::pi / 2;
  int passed = 0;  // four extreme points are all of them
  for (double k = std::ceil(first / kQuarter); k * kQuarter <= last && passed < 4; ++k, ++passed) {
    include(extent, pivot.x + radius * std::cos(k * kQuarter),
            pivot.y + radius * std::sin(k * kQuarter));
  }
}

}  // namespace

Sweep::Sweep(const Vehicle& vehicle, const Pose& from, const Arc& arc)
    : x_(from.x),
      y_(from.y),
      ux_(std::cos(from.theta)),
      uy_(std::sin(from.theta)),
      length_(arc.length),
      turn_(arc.length * arc.curvature),
      ahead_((vehicle.front - vehicle.rear) / 2),
      half_length_(vehicle.length() / 2),
      half_width_(vehicle.width / 2) {
  // The fastest point is a corner: (along, across) in the car's frame moves with |1 - k across| and
  // |k along| times the speed of the rear axle.
  const double along = std::max(std::abs(vehicle.front), std::abs(vehicle.rear));
  const double k = std::abs(arc.curvature);
  const double ahead = k * along;
  const double aside = 1.0 + k * half_width_;
  travel_ = std::abs(length_) * std::sqrt(aside * aside + ahead * ahead);
  const OrientedBox middle = at(0.5);
  centre_ = {middle.x, middle.y};
  radius_ = std::sqrt(half_length_ * half_length_ + half_width_ * half_width_) + travel_ / 2;
}

Sweep Sweep::moved_to(const Frame& in) const {
  Sweep moved = *this;
  const Point start = in.world(x_, y_);
  moved.x_ = start.x;
  moved.y_ = start.y;
  moved.ux_ = in.ux * ux_ - in.uy * uy_;
  moved.uy_ = in.uy * ux_ + in.ux * uy_;
  moved.centre_ = in.world(centre_.x, centre_.y);
  return moved;
}

OrientedBox Sweep::at(double s) const {
  const Trig t = trig(turn_ * s);
  const double along = length_ * s * t.sinc;
  const double aside = length_ * s * t.cosc;
  const double ux = ux_ * t.cos - uy_ * t.sin;
  const double uy = uy_ * t.cos + ux_ * t.sin;
  return {x_ + ux_ * along - uy_ * aside + ahead_ * ux,
          y_ + uy_ * along + ux_ * aside + ahead_ * uy,
          ux,
          uy,
          half_length_,
          half_width_};
}

OrientedBox Sweep::around() const {
  OrientedBox box = at(0.5);
  if (std::abs(turn_) > 1.0) {
    box.half_length = box.half_width = radius_;
    return box;
  }
  // Seen from half way, beginning and end mirror each other. Corners go on arcs of circles: they
  // get further than at the three time steps by no more than the sagitta of half the arc.
  const Trig t = trig(turn_ / 2);
  const double sine = std::abs(t.sin);
  const double driven = std::abs(length_ / 2 * t.sinc);
  const double back = ahead_ * (t.cos - 1.0);
  const double aside = length_ / 2 * t.cosc;
  const double swing = std::abs(ahead_ * t.sin);
  const double half_length = half_length_ * t.cos + half_width_ * sine;
  const double half_width = half_length_ * sine + half_width_ * t.cos;
  const double front = std::max(back + driven + half_length, half_length_);
  const double rear = std::min(back - driven - half_length, -half_length_);
  const double left = std::max(aside + swing + half_width, half_width_);
  const double right = std::min(aside - swing - half_width, -half_width_);
  const double bulge = travel_ * std::abs(turn_) / 32;
  const Point middle =
      Frame(box.x, box.y, box.ux, box.uy).world((front + rear) / 2, (left + right) / 2);
  return {
      middle.x, middle.y, box.ux, box.uy, (front - rear) / 2 + bulge, (left - right) / 2 + bulge};
}

bool collide(const Sweep& a, const Sweep& b) {
  if (circles_apart(a, b.centre(), b.radius())) return false;
  return !stays_clear([&](double s) { return separation(a.at(s), b.at(s)); },
                      a.travel() + b.travel());
}

bool collide(const Sweep& sweep, const Point& centre, double radius) {
  if (circles_apart(sweep, centre, radius)) return false;
  return !stays_clear([&](double s) { return separation(sweep.at(s), centre) - radius; },
                      sweep.travel());
}

bool collide(const Sweep& sweep, const OrientedBox& box) {
  // Most boxes are farther than this, and the distance would take a root.
  if (circles_apart(sweep, {box.x, box.y}, box.half_length + box.half_width)) return false;
  if (separation(box, sweep.centre()) > sweep.radius()) return false;
  return !stays_clear([&](double s) { return separation(sweep.at(s), box); }, sweep.travel());
}

Extent axle_extent(const Pose& from, const Arc& arc) {
  Extent extent = kNothing;
  include_path_of_point(extent, from, arc, 0.0, 0.0);
  return extent;
}

Extent body_extent(const Vehicle& vehicle, const Pose& from, const Arc& arc) {
  Extent extent = kNothing;
  for (const double ahead : {vehicle.front, -vehicle.rear}) {
    for (const double left : {vehicle.width / 2, -vehicle.width / 2}) {
      include_path_of_point(extent, from, arc, ahead, left);
    }
  }
  return extent;
}

}  // namespace mvtp
