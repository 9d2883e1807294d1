#pragma once

#include <string>
#include <vector>

#include "planner/geometry.hpp"
#include "planner/problem/plan.hpp"
#include "tools/toio/cube/mat_frame.hpp"

namespace mvtp {

/// One step of a trajectory: an arc, or a wait (length 0).
struct Leg {
  Pose from;
  Arc arc;
  Pose drift;  ///< small rest that joins the arc's end to the pose in the plan; world frame

  /// The pose after the share s in [0, 1] of the step.
  [[nodiscard]] Pose at(double s) const {
    const Pose arc_pose = drive(from, s * arc.length, arc.curvature);
    return {arc_pose.x + s * drift.x, arc_pose.y + s * drift.y,
            wrap_to_pi(arc_pose.theta + s * drift.theta)};
  }
};

/// The steps of a trajectory, in the frame of the plan. Waits after the arrival are left out.
/// @param where names the trajectory in messages: "plan.yaml: schedule.agent0".
/// @throws InputError at a step that no car can drive as one arc.
[[nodiscard]] std::vector<Leg> legs_of(const Trajectory& trajectory, const std::string& where);

/// The same motion on the desk.
[[nodiscard]] std::vector<Leg> to_desk(const PlanFrame& frame, const std::vector<Leg>& legs);

/// One moment of a motion on the desk.
struct MotionSample {
  double time = 0.0;       ///< since the start of the run [s]
  double plan_time = 0.0;  ///< the time in the plan at which it is there [s of the plan]
  Pose pose;
  int direction = 0;   ///< 1 forwards, -1 backwards, 0 at rest
  double speed = 0.0;  ///< [m/s], >= 0; changes evenly in time until the next moment
};

/// How fast the desk's motion may be.
struct Pace {
  double speedup = 1.0;  ///< seconds of the plan per second
  double accel = 0.2;    ///< [m/s^2]
  Cube cube;
};

/// Times a path anew so that a cube can drive it.
///
/// Between stops (cusps, waits, the goal) the cube drives with the speed of the plan, sped up,
/// under the acceleration limit, and nowhere slower than its wheels can turn evenly. It leaves
/// no earlier than the plan says; where it is late, the next wait is shorter.
/// @param dt duration of a step in the plan [s].
/// @return moments at most 0.25 mm or a wait apart, in order; times and plan times never fall.
[[nodiscard]] std::vector<MotionSample> retime(const std::vector<Leg>& desk_legs, const Pose& start,
                                               double dt, const Pace& pace);

/// The state at a time between the first and the last instant; rests before and after.
[[nodiscard]] MotionSample at_time(const std::vector<MotionSample>& samples, double time);

/// When the motion reaches a time of the plan [s]; the end of the motion for later ones.
[[nodiscard]] double time_of(const std::vector<MotionSample>& samples, double plan_time);

}  // namespace mvtp
