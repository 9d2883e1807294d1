#pragma once

#include <algorithm>
#include <cmath>

#include "planner/problem/vehicle.hpp"
#include "tools/toio/cube/protocol.hpp"

namespace mvtp {

/// The body and the wheels of a toio Core Cube; metres, seconds.
///
/// Source: toio Core Cube Specification 2.5.0, hardware_shape, hardware_other and the graph of
/// ble_motor; what only a measurement on the cube at hand can settle is `mvtp toio calibrate`'s.
struct Cube {
  double front = 0.0121;  ///< from the wheel axle to the front of the body
  double rear = 0.0197;   ///< from the wheel axle to its rear
  double width = 0.0318;
  double track = 0.0266;  ///< between the wheels
  /// How far the axle is ahead of the point that the cube reports as its centre: 0.0038 if that is
  /// the middle of the body, 0 if it is the axle itself.
  double center_to_axle = 0.0038;
  double sensor_behind = 0.0149;  ///< of the axle
  double sensor_left = 0.0094;    ///< of the middle
  double speed_per_unit = 0.002814;
  int dead_zone = 8;   ///< wheels stand still below this many units
  int max_unit = 115;  ///< and turn no faster above this many

  [[nodiscard]] double least_speed() const { return dead_zone * speed_per_unit; }
  [[nodiscard]] double top_speed() const { return max_unit * speed_per_unit; }

  friend bool operator==(const Cube&, const Cube&) = default;
};

/// Which end of the cube goes first where the plan drives forwards. A car's body reaches further
/// ahead of its rear axle than behind it, a cube's the other way round of its wheels.
enum class Facing { kNoseFirst, kTailFirst };

/// How far a cube may be from where it should be [m].
struct TrackingMargins {
  double lateral = 0.005;
  double along = 0.0065;

  friend bool operator==(const TrackingMargins&, const TrackingMargins&) = default;
};

/// The cube with margins as a car: a rectangle around its axle, with its front where it drives to.
[[nodiscard]] inline Vehicle body_of(const Cube& cube, Facing facing,
                                     const TrackingMargins& margins) {
  Vehicle body;
  const bool nose_first = facing == Facing::kNoseFirst;
  body.front = (nose_first ? cube.front : cube.rear) + margins.along;
  body.rear = (nose_first ? cube.rear : cube.front) + margins.along;
  body.width = cube.width + 2.0 * margins.lateral;
  return body;
}

/// Speed of the axle's middle [m/s] and turning rate [rad/s, counter-clockwise], as a car.
struct Twist {
  double v = 0.0;
  double omega = 0.0;
};

/// The wheel speeds that drive the axle so, not rounded, in units; the cube's own left and right.
struct ExactUnits {
  double left = 0.0;
  double right = 0.0;
};
[[nodiscard]] inline ExactUnits exact_units(const Cube& cube, Facing facing, const Twist& twist) {
  const double turn = twist.omega * cube.track / 2.0;
  const double left = (twist.v - turn) / cube.speed_per_unit;
  const double right = (twist.v + turn) / cube.speed_per_unit;
  if (facing == Facing::kNoseFirst) return {left, right};
  return {-right, -left};
}

/// The whole units nearest to a wheel's speed that turn the wheel so, or stand.
[[nodiscard]] inline int whole_units(const Cube& cube, double units) {
  const double size = std::min(std::abs(units), double(cube.max_unit));
  if (size < 0.5 * cube.dead_zone) return 0;
  const int whole = std::max(cube.dead_zone, int(std::lround(size)));
  return units < 0.0 ? -whole : whole;
}

[[nodiscard]] inline WheelUnits wheel_units(const Cube& cube, Facing facing, const Twist& twist) {
  const ExactUnits exact = exact_units(cube, facing, twist);
  return {whole_units(cube, exact.left), whole_units(cube, exact.right)};
}

/// What the wheels do at these units: none below the dead zone, no more above the largest.
[[nodiscard]] inline double wheel_speed(const Cube& cube, int units) {
  if (std::abs(units) < cube.dead_zone) return 0.0;
  return std::clamp(units, -cube.max_unit, cube.max_unit) * cube.speed_per_unit;
}

/// The slowest speed of the axle's middle along an arc at which the inner wheel still turns evenly
/// [m/s]. Where that wheel nearly stands no speed will do, and five times the least is enough.
[[nodiscard]] inline double least_speed(const Cube& cube, double curvature) {
  const double inner = 1.0 - std::abs(curvature) * cube.track / 2.0;
  return cube.least_speed() / std::max(inner, 0.2);
}

}  // namespace mvtp
