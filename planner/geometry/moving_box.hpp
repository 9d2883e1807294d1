#pragma once

#include <algorithm>
#include <cmath>

#include "planner/geometry/frame.hpp"
#include "planner/problem/pose.hpp"
#include "planner/problem/vehicle.hpp"

namespace mvtp {

/// Where a body is: its middle and the unit vector along it [m]. Single precision: what collision
/// tests of many robots stream through.
struct BoxPose {
  float x = 0.0F;
  float y = 0.0F;
  float ux = 1.0F;
  float uy = 0.0F;
};

/// The size of a body and how fast its corners can move.
struct BoxShape {
  float half_length = 0.0F;
  float half_width = 0.0F;
  /// No point of the body makes a longer path than this between two time steps [m].
  float travel = 0.0F;

  [[nodiscard]] float half_diagonal() const { return std::hypot(half_length, half_width); }
};

/// The body of `vehicle`; time steps are `dt` [s] apart.
[[nodiscard]] BoxShape box_shape(const Vehicle& vehicle, double dt);

/// The body whose rear axle is at `frame` and whose middle is `ahead` [m] of it.
[[nodiscard]] inline BoxPose box_pose(const Frame& frame, double ahead) {
  return {float(frame.x + ahead * frame.ux), float(frame.y + ahead * frame.uy), float(frame.ux),
          float(frame.uy)};
}

[[nodiscard]] inline BoxPose box_pose(const Vehicle& vehicle, const Pose& pose) {
  return box_pose(Frame(pose), (vehicle.front - vehicle.rear) / 2);
}

/// A box given in the frame of a car, in the world.
[[nodiscard]] inline BoxPose moved(const BoxPose& box, const Frame& car) {
  const Point middle = car.world(double(box.x), double(box.y));
  const float ux = float(car.ux);
  const float uy = float(car.uy);
  return {float(middle.x), float(middle.y), ux * box.ux - uy * box.uy, uy * box.ux + ux * box.uy};
}

/// The widest gap between two bodies along the directions of their sides [m]: negative if and only
/// if they overlap (separating axis theorem).
[[nodiscard]] inline float gap(const BoxPose& a, const BoxShape& size_a, const BoxPose& b,
                               const BoxShape& size_b) {
  const float dx = b.x - a.x;
  const float dy = b.y - a.y;
  const float c = std::abs(a.ux * b.ux + a.uy * b.uy);
  const float s = std::abs(a.ux * b.uy - a.uy * b.ux);
  const float along_a = std::abs(dx * a.ux + dy * a.uy) - size_a.half_length -
                        size_b.half_length * c - size_b.half_width * s;
  const float across_a = std::abs(dy * a.ux - dx * a.uy) - size_a.half_width -
                         size_b.half_length * s - size_b.half_width * c;
  const float along_b = std::abs(dx * b.ux + dy * b.uy) - size_b.half_length -
                        size_a.half_length * c - size_a.half_width * s;
  const float across_b = std::abs(dy * b.ux - dx * b.uy) - size_b.half_width -
                         size_a.half_length * s - size_a.half_width * c;
  return std::max(std::max(along_a, across_a), std::max(along_b, across_b));
}

/// A box that contains a moving body for some time: quick proof that two bodies do not meet.
struct SweptBox {
  BoxPose pose;
  float half_length = 0.0F;
  float half_width = 0.0F;
};

[[nodiscard]] inline SweptBox moved(const SweptBox& box, const Frame& car) {
  return {moved(box.pose, car), box.half_length, box.half_width};
}

/// A box around the body while it moves through `boxes[0] ... boxes[steps]`, one arc of a circle
/// between two time steps each, aligned with the body half way.
[[nodiscard]] SweptBox swept_box(const BoxPose* boxes, const BoxShape& size, int steps);

/// True only if the two have no point in common.
[[nodiscard]] inline bool apart(const SweptBox& a, const SweptBox& b) {
  return gap(a.pose, {a.half_length, a.half_width}, b.pose, {b.half_length, b.half_width}) > 0.0F;
}

/// Do two bodies overlap while each moves through `a[0] ... a[steps]` and `b[0] ... b[steps]`, one
/// arc of a circle between two time steps each?
///
/// By bisection, down to between the time steps where the gaps prove nothing. Overlaps of up to
/// kBoxTouch are no overlaps. The `travel` of each size need hold for these motions only: 0 at
/// rest.
[[nodiscard]] bool meet(const BoxPose* a, const BoxShape& size_a, const BoxPose* b,
                        const BoxShape& size_b, int steps);

/// Overlap that counts as a touch [m]: a third of the referee's tolerance.
inline constexpr float kBoxTouch = 0.0003F;

}  // namespace mvtp
