#include "planner/problem/referee_step.hpp"

#include <cmath>

#include "planner/problem/referee_tolerances.hpp"

namespace mvtp::referee {

bool states_its_arc(const Waypoint& waypoint) {
  return !std::isnan(waypoint.v) && !std::isnan(waypoint.phi);
}

Arc claimed_arc(const Vehicle& vehicle, const Pose& from, const Waypoint& to, double dt) {
  if (!states_its_arc(to)) return joining_arc(from, to.pose);
  return {to.v * dt, std::tan(to.phi) / vehicle.wheelbase};
}

Pose drift(const Pose& from, const Arc& arc, const Pose& to) {
  const Pose end = drive(from, arc.length, arc.curvature);
  return {to.x - end.x, to.y - end.y, wrap_to_pi(to.theta - end.theta)};
}

bool is_small(const Pose& difference, double tolerance) {
  return std::hypot(difference.x, difference.y) <= tolerance &&
         std::abs(difference.theta) <= tolerance;
}

Motion motion_of(const Vehicle& vehicle, const Pose& from, const Waypoint& to, double dt) {
  const double tolerance = states_its_arc(to) ? kStatedArcTolerance : kJoiningArcTolerance;
  const Arc claimed = claimed_arc(vehicle, from, to, dt);
  const Pose rest = drift(from, claimed, to.pose);
  if (is_small(rest, tolerance)) return {from, claimed.length, claimed.curvature, rest};

  const Arc joining = joining_arc(from, to.pose);
  const Pose joining_rest = drift(from, joining, to.pose);
  if (is_small(joining_rest, kJoiningArcTolerance)) {
    return {from, joining.length, joining.curvature, joining_rest};
  }
  return {from, 0.0, 0.0, drift(from, {}, to.pose)};
}

}  // namespace mvtp::referee
