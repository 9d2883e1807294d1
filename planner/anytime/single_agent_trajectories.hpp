#pragma once

#include <optional>
#include <vector>

#include "planner/escot/planning_problem.hpp"
#include "planner/problem/deadline.hpp"
#include "planner/search/joint_motion.hpp"
#include "planner/search/soft_hybrid_astar.hpp"

namespace mvtp {

/// A robot's path to its goal as if it were alone.
/// @param weight  of the cost-to-go, >= 1
/// @param finer   so many times smaller are the cells of the search; slow steps are used if > 0
/// @return nullopt if none was found in so many expansions or until the deadline
[[nodiscard]] std::optional<ArcTrajectory> find_single_agent_trajectory(SoftHybridAstar& search,
                                                                        const MacroRobot& robot,
                                                                        double weight,
                                                                        int expansions, int finer,
                                                                        const Deadline& deadline);

/// Every robot's single-agent path: by a quick search, by hybrid A* with steps of several lengths,
/// or by ever finer searches; empty if one was not found.
/// @param robots  those of the problem, in its order
[[nodiscard]] std::vector<ArcTrajectory> find_single_agent_trajectories(
    const PlanningProblem& problem, const std::vector<MacroRobot>& robots,
    const Deadline& deadline);

}  // namespace mvtp
