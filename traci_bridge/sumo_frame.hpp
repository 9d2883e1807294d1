#pragma once

#include <cmath>
#include <numbers>

#include "planner/problem/pose.hpp"
#include "planner/problem/vehicle.hpp"

namespace mvtp {

/// A vehicle's position as SUMO reports it: front-bumper centre [m], compass angle [deg].
struct SumoPosition {
  double x_m = 0.0;
  double y_m = 0.0;
  double angle_deg = 0.0;  ///< clockwise from north (+y), in [0, 360)
};

/// @param front_overhang distance from the rear axle to the front bumper [m], Vehicle::front.
[[nodiscard]] inline Pose from_sumo(const SumoPosition& p, double front_overhang) {
  const double theta = wrap_to_pi((90.0 - p.angle_deg) * std::numbers::pi / 180.0);
  return compose({p.x_m, p.y_m, theta}, {-front_overhang, 0.0, 0.0});
}

/// The inverse of from_sumo(). @pre the pose is finite: SUMO loops for ever on an infinite angle.
[[nodiscard]] inline SumoPosition to_sumo(const Pose& pose, double front_overhang) {
  const Pose front = compose(pose, {front_overhang, 0.0, 0.0});
  const double angle = 90.0 - front.theta * 180.0 / std::numbers::pi;  // in [-90, 270)
  const double wrapped = angle < 0.0 ? angle + 360.0 : angle;
  return {front.x, front.y, wrapped < 360.0 ? wrapped : 0.0};  // -1e-15 + 360 rounds to 360
}

/// The body of a vehicle of which SUMO only knows the length and the width [m]: where its axles
/// are and how tight it turns is the one assumption that is made here.
///
/// Cars: rear overhang 0.2 L, wheelbase 0.6 L, steering up to 35 degrees. Longer than 7 m: a bus or
/// truck with rear overhang 0.28 L, wheelbase 0.5 L, steering up to 45 degrees.
/// Its speed and acceleration limits are left at their defaults.
[[nodiscard]] inline Vehicle body_of(double length, double width) {
  const bool car = length <= 7.0;
  const double rear = (car ? 0.2 : 0.28) * length;
  const double wheelbase = (car ? 0.6 : 0.5) * length;
  const double max_steering = (car ? 35.0 : 45.0) * std::numbers::pi / 180.0;
  Vehicle body;
  body.front = length - rear;
  body.rear = rear;
  body.width = width;
  body.wheelbase = wheelbase;
  body.min_turning_radius = wheelbase / std::tan(max_steering);
  return body;
}

}  // namespace mvtp
