#include "planner/problem/validate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planner/problem/judged_plan.hpp"
#include "planner/problem/referee_protocol.hpp"
#include "planner/problem/referee_space.hpp"
#include "planner/problem/referee_step.hpp"
#include "planner/problem/referee_tolerances.hpp"
#include "planner/problem/violation_message.hpp"

namespace mvtp::referee {
namespace {

/// The plan begins at the starts and ends at the goals.
void judge_ends(const JudgedPlan& plan, std::size_t i, Protocol& protocol) {
  const auto judge = [&](Rule rule, const Pose& wanted, std::size_t step, double tolerance) {
    const Pose& is = plan.trajectory(i).at(step).pose;
    const double turn = std::abs(wrap_to_pi(is.theta - wanted.theta));
    const double away = distance(is, wanted);
    if (away <= tolerance && turn <= tolerance) return;
    protocol.add(rule, i, 0, step, double(step), away, turn);
  };
  judge(Rule::kStart, plan.agent(i).start, 0, kStartTolerance);
  judge(Rule::kGoal, plan.agent(i).goal, plan.trajectory(i).makespan(), kGoalTolerance);
}

/// The vehicle can drive this arc in one step.
void judge_limits(const JudgedPlan& plan, std::size_t i, std::size_t step, const Arc& arc,
                  bool is_stated, Protocol& protocol) {
  const Vehicle& vehicle = plan.agent(i).vehicle;
  const double dt = plan.dt();
  const double slack = is_stated ? 0.0 : kJoiningArcTolerance;
  const double length = std::abs(arc.length);
  const double longest = vehicle.max_speed * dt * (1.0 + kLimitTolerance) + slack;
  if (!(length <= longest)) {
    protocol.add(Rule::kSpeed, i, 0, step, double(step), length / dt);
  }
  const double turn = length * std::abs(arc.curvature);
  const double sharpest = length * vehicle.max_curvature() * (1.0 + kLimitTolerance) + slack;
  const double phi = plan.trajectory(i).at(step).phi;
  const bool beyond_right_angle =
      is_stated && length > 0.0 && !(std::abs(phi) < 0.5 * std::numbers::pi);
  if (!(turn <= sharpest) || beyond_right_angle) {
    protocol.add(Rule::kCurvature, i, 0, step, double(step), std::abs(arc.curvature));
  }
}

/// Each step is an arc, the one that it says, and within the limits of the vehicle.
void judge_kinematics(const JudgedPlan& plan, std::size_t i, Protocol& protocol) {
  const std::vector<Waypoint>& waypoints = plan.trajectory(i).waypoints();
  for (std::size_t step = 1; step < waypoints.size(); ++step) {
    const Pose& from = waypoints[step - 1].pose;
    const Waypoint& to = waypoints[step];
    const bool is_stated = states_its_arc(to);
    const Arc arc = claimed_arc(plan.agent(i).vehicle, from, to, plan.dt());
    const Pose rest = drift(from, arc, to.pose);
    const double tolerance = is_stated ? kStatedArcTolerance : kJoiningArcTolerance;
    if (!is_small(rest, tolerance)) {
      protocol.add(Rule::kArc, i, 0, step, double(step), std::hypot(rest.x, rest.y),
                   std::abs(rest.theta));
    }
    judge_limits(plan, i, step, arc, is_stated, protocol);
  }
}

}  // namespace
}  // namespace mvtp::referee

namespace mvtp {

const char* to_string(Rule rule) {
  switch (rule) {
    case Rule::kAgentMissing:
      return "agent missing";
    case Rule::kAgentUnknown:
      return "agent unknown";
    case Rule::kNotFinite:
      return "not finite";
    case Rule::kStart:
      return "start";
    case Rule::kGoal:
      return "goal";
    case Rule::kArc:
      return "arc";
    case Rule::kCurvature:
      return "curvature";
    case Rule::kSpeed:
      return "speed";
    case Rule::kRobotOverlap:
      return "robot overlap";
    case Rule::kObstacleOverlap:
      return "obstacle overlap";
    case Rule::kBounds:
      return "bounds";
  }
  return "";
}

std::vector<Violation> find_violations(const Instance& instance, const Plan& plan,
                                       CollisionRule rule) {
  referee::Protocol protocol;
  const referee::JudgedPlan judged(instance, plan, protocol);
  for (const std::size_t i : judged.present()) {
    referee::judge_ends(judged, i, protocol);
    referee::judge_kinematics(judged, i, protocol);
  }
  referee::judge_space(judged, rule, protocol);
  std::vector<Violation> violations;
  for (const referee::Protocol::Entry& entry : protocol.entries()) {
    violations.push_back(referee::to_violation(entry, instance, plan));
  }
  return violations;
}

}  // namespace mvtp
