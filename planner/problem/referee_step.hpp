#pragma once

#include "planner/problem/plan.hpp"
#include "planner/problem/referee_geometry.hpp"
#include "planner/problem/vehicle.hpp"

/// One step of one vehicle as the referee reads it: what the plan says of it, and what is followed.
namespace mvtp::referee {

/// Does the step that ends here say its arc by v and phi?
[[nodiscard]] bool states_its_arc(const Waypoint& waypoint);

/// The arc that v and phi say, or else the one that joins the poses. The step lasts `dt` [s].
[[nodiscard]] Arc claimed_arc(const Vehicle& vehicle, const Pose& from, const Waypoint& to,
                              double dt);

/// From where the arc ends to where the plan says that the step ends, in the world frame.
[[nodiscard]] Pose drift(const Pose& from, const Arc& arc, const Pose& to);

/// False for NaN too.
[[nodiscard]] bool is_small(const Pose& difference, double tolerance);

/// The motion that the referee follows: the claimed arc if it leads to the next pose, else the arc
/// that joins the poses, else the straight line.
[[nodiscard]] Motion motion_of(const Vehicle& vehicle, const Pose& from, const Waypoint& to,
                               double dt);

}  // namespace mvtp::referee
