#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "planner/problem/instance.hpp"
#include "planner/problem/plan.hpp"

namespace mvtp {

/// The rules of the referee; one plan can break each of them alone.
enum class Rule {
  kAgentMissing,     ///< an agent of the instance has no trajectory
  kAgentUnknown,     ///< a trajectory belongs to no agent, or to one that has another already
  kNotFinite,        ///< a pose is NaN or infinite; the agent is judged no further
  kStart,            ///< the first pose is not the start
  kGoal,             ///< the last pose is farther than 0.1 m or 0.1 rad from the goal
  kArc,              ///< a step is no arc, or not the one that its v and phi say
  kCurvature,        ///< an arc is tighter than the vehicle's least turning radius
  kSpeed,            ///< an arc is longer than max_speed * dt
  kRobotOverlap,     ///< two footprints overlap
  kObstacleOverlap,  ///< a footprint overlaps a circle or polygon
  kBounds,           ///< the rear axle or the footprint (Map::bounds) leaves the map
};

[[nodiscard]] const char* to_string(Rule rule);

/// One broken rule: where, when, and by how much. Steps in a row are one violation.
struct Violation {
  Rule rule;
  std::vector<std::string> agents;  ///< one name, or the two that overlap
  double step = 0.0;                ///< when it begins [steps]; fractional between steps
  double amount = 0.0;              ///< in the rule's unit: m, rad, 1/m, m/s; 0 where none applies
  std::string message;              ///< one line without the file's name
};

/// Overlaps up to this depth [m] are touches, which are allowed.
inline constexpr double kTouchTolerance = 1e-3;

/// The referee: every rule that the plan breaks, in the order of the rules, then of the agents,
/// then of time; empty for a valid plan.
///
/// Its geometry is its own: solver and judge share no collision test. Under kContinuous the
/// judgement is exact between steps too: each step is followed along its arc with a proven bound on
/// the speed of every point of the body, so that no overlap deeper than 1.01 mm is missed, and none
/// of less than 1 mm is reported. Vehicles that have arrived rest at their last pose until the last
/// one arrives. Steps whose v is NaN get the arc that joins their poses; where there is none, the
/// straight line is followed (and kArc reported).
/// Under InitialOverlap::kAllow, places that overlap are exempt: see OverlappingPlace.
/// The step lasts `plan.statistics.dt`.
/// Cost: O(T (n log n + near pairs)) for n robots and T steps.
[[nodiscard]] std::vector<Violation> find_violations(const Instance& instance, const Plan& plan,
                                                     CollisionRule rule);

}  // namespace mvtp
