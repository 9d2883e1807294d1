#include "planner/geometry/moving_box.hpp"

namespace mvtp {
namespace {

/// Half way between two time steps of a motion along one arc: the chord's middle, pushed out by
/// the sagitta chord / 2 * tan(turn / 4), for the body turns evenly about one point.
BoxPose halfway(const BoxPose& p, const BoxPose& q) {
  const float sine = p.ux * q.uy - p.uy * q.ux;
  const float sagitta = 0.125F * sine;  // turns are small: tan(turn / 4) / 2 to the third order
  const float dx = q.x - p.x;
  const float dy = q.y - p.y;
  const float ux = p.ux + q.ux;
  const float uy = p.uy + q.uy;
  const float norm = 1.0F / std::sqrt(ux * ux + uy * uy);
  return {0.5F * (p.x + q.x) + sagitta * dy, 0.5F * (p.y + q.y) - sagitta * dx, ux * norm,
          uy * norm};
}

struct Instant {
  BoxPose a;
  BoxPose b;
  float gap;
};

/// The search for an overlap between two time steps whose gaps g0, g1 are known: between them the
/// gap is at least (g0 + g1 - travel) / 2.
class Bisection {
 public:
  Bisection(const BoxPose* a, const BoxShape& size_a, const BoxPose* b, const BoxShape& size_b)
      : a_(a), b_(b), size_a_(size_a), size_b_(size_b), travel_(size_a.travel + size_b.travel) {}

  [[nodiscard]] float gap_at(int t) const { return gap(a_[t], size_a_, b_[t], size_b_); }
  [[nodiscard]] float travel(int time_steps) const { return travel_ * float(time_steps); }

  [[nodiscard]] bool overlap(int from, float gap_from, int to, float gap_to) const {
    if (gap_from + gap_to >= travel(to - from)) return false;
    if (to - from == 1) {
      return overlap_between({a_[from], b_[from], gap_from}, {a_[to], b_[to], gap_to}, travel_);
    }
    const int middle = (from + to) / 2;
    const float between = gap_at(middle);
    return between < -kBoxTouch || overlap(from, gap_from, middle, between) ||
           overlap(middle, between, to, gap_to);
  }

 private:
  [[nodiscard]] bool overlap_between(const Instant& from, const Instant& to, float travel) const {
    if (from.gap + to.gap >= travel || travel < kBoxTouch) return false;
    Instant middle{halfway(from.a, to.a), halfway(from.b, to.b), 0.0F};
    middle.gap = gap(middle.a, size_a_, middle.b, size_b_);
    return middle.gap < -kBoxTouch || overlap_between(from, middle, travel / 2) ||
           overlap_between(middle, to, travel / 2);
  }

  const BoxPose* a_;
  const BoxPose* b_;
  const BoxShape& size_a_;
  const BoxShape& size_b_;
  float travel_;
};

}  // namespace

BoxShape box_shape(const Vehicle& vehicle, double dt) {
  const double curvature = vehicle.max_curvature();
  const double far = std::max(std::abs(vehicle.front), std::abs(vehicle.rear));
  // The corner that is farthest from the centre of the tightest turn.
  const double reach = std::hypot(far * curvature, 1.0 + vehicle.width / 2 * curvature);
  return {float(vehicle.length() / 2), float(vehicle.width / 2),
          float(vehicle.max_speed * dt * reach)};
}

SweptBox swept_box(const BoxPose* boxes, const BoxShape& size, int steps) {
  const BoxPose& middle = boxes[steps / 2];
  float ahead = 0.0F;  // the farthest that any corner gets, in the frame of the middle
  float behind = 0.0F;
  float left = 0.0F;
  float right = 0.0F;
  float bulge = 0.0F;  // of a point's arc over its chord
  for (int t = 0; t <= steps; ++t) {
    const BoxPose& box = boxes[t];
    const float dx = box.x - middle.x;
    const float dy = box.y - middle.y;
    const float along = dx * middle.ux + dy * middle.uy;
    const float across = dy * middle.ux - dx * middle.uy;
    const float c = std::abs(box.ux * middle.ux + box.uy * middle.uy);
    const float s = std::abs(box.uy * middle.ux - box.ux * middle.uy);
    const float half_length = size.half_length * c + size.half_width * s;
    const float half_width = size.half_length * s + size.half_width * c;
    ahead = std::max(ahead, along + half_length);
    behind = std::min(behind, along - half_length);
    left = std::max(left, across + half_width);
    right = std::min(right, across - half_width);
    if (t == steps) break;
    const BoxPose& next = boxes[t + 1];
    // An arc bulges by length * turn / 8; a seventh is more for turns of up to half a radian.
    const float turn = std::abs(box.ux * next.uy - box.uy * next.ux);
    const bool small = turn < 0.5F && box.ux * next.ux + box.uy * next.uy > 0.0F;
    bulge = std::max(bulge, small ? turn / 7.0F : 0.5F);
  }
  bulge *= size.travel;
  const float x = 0.5F * (ahead + behind);
  const float y = 0.5F * (left + right);
  return {{middle.x + x * middle.ux - y * middle.uy, middle.y + x * middle.uy + y * middle.ux,
           middle.ux, middle.uy},
          0.5F * (ahead - behind) + bulge,
          0.5F * (left - right) + bulge};
}

bool meet(const BoxPose* a, const BoxShape& size_a, const BoxPose* b, const BoxShape& size_b,
          int steps) {
  const Bisection pair(a, size_a, b, size_b);
  // Most pairs are far enough apart half way through to need no second look.
  const int middle = steps / 2;
  const float halfway = pair.gap_at(middle);
  if (halfway < -kBoxTouch) return true;
  if (halfway >= pair.travel(steps - middle)) return false;
  const float first = pair.gap_at(0);
  const float last = pair.gap_at(steps);
  return first < -kBoxTouch || last < -kBoxTouch || pair.overlap(0, first, middle, halfway) ||
         pair.overlap(middle, halfway, steps, last);
}

}  // namespace mvtp
