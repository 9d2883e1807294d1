#pragma once

/// @file
/// Maps: one instance, its plan by an algorithm that is named.
///
/// What a caller does, in this order: read_instance(), or an Instance of its own; check_instance(),
/// which says what is wrong with it; solve(); find_violations(), which judges the plan;
/// write_plan(). Who makes instances asks robots_without_single_agent_path() before.
///
/// - Units: metres, seconds, radians; times in steps of Instance::dt, or of Statistics::dt in a
///   plan.
/// - Frame: the map is [0, width] x [0, height]; headings are counter-clockwise from +x, and the
///   pose of a robot is that of its rear axle.
/// - Shapes: Plan::names, vehicles and trajectories have one entry per agent, in the order of the
///   instance; a Trajectory has one Waypoint per step, the start first, and rests at its last pose.
/// - Errors: InputError for a name it does not know. That there is no plan is a result, not an
///   error: Statistics::status says so, and Statistics::reason why.
/// - Sources: the ESCoT paper, and those of the planners it is compared with; see
///   planner/escot/README.md and planner/anytime/README.md.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "planner/problem/deadline.hpp"
#include "planner/problem/instance.hpp"
#include "planner/problem/pbcr_score.hpp"
#include "planner/problem/plan.hpp"

namespace mvtp {

struct SolveOptions {
  std::string algorithm = "escot";  ///< one of algorithm_names()
  CollisionRule collision = CollisionRule::kContinuous;
  std::uint64_t seed = 0;
  int runs = 1;                 ///< tried one after the other with seeds seed, seed + 1, ...; >= 1
  double run_time_limit = 1e9;  ///< of each run [s], > 0
  double gap = 0.01;            ///< escot-star stops at a makespan of (1 + gap) * lower bound, >= 0
  int threads = 1;              ///< of escot-star, >= 1; the others use one
  PbcrScore pbcr = PbcrScore::kStrengthened;  ///< of escot and pbcr
};

/// The algorithms that solve() knows, the default first.
[[nodiscard]] const std::vector<std::string>& algorithm_names();

/// Plans for all robots.
///
/// `statistics` of the result is filled but for `version`; `seed` is that of the last run. Its
/// trajectories end exactly at the goals if the status is "solved"; else they are as far as the
/// search came, or empty. Same instance and options give the same plan but for
/// `statistics.runtime`, unless the deadline ends the search.
/// @throws InputError for an unknown algorithm.
[[nodiscard]] Plan solve(const Instance& instance, const SolveOptions& options,
                         const Deadline& deadline);

/// The robots for which no path was found, all others absent: places in Instance::agents,
/// ascending.
///
/// If there are none, each robot can get to its goal alone: that is proven. A robot that is among
/// them may be able to all the same: its search ends after a number of expansions. The clock plays
/// no part, so the same instance gives the same robots on every machine.
[[nodiscard]] std::vector<std::size_t> robots_without_single_agent_path(const Instance& instance);

}  // namespace mvtp
