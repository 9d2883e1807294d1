#pragma once

#include <cstdint>

#include "planner/escot/planner_result.hpp"
#include "planner/escot/planning_problem.hpp"
#include "planner/problem/deadline.hpp"

namespace mvtp {

struct EscotStarOptions {
  std::uint64_t seed = 0;
  double gap = 0.01;  ///< good enough is a makespan of (1 + gap) * lower bound, >= 0
  int threads = 1;    ///< searchers side by side, >= 1
};

/// ESCoT*: near-optimal plans, improved until the deadline or the gap.
///
/// 1. Every robot alone (find_single_agent_trajectories), by a search that could drive through
/// others at a soft-collision cost
///    (SoftHybridAstar).
/// 2. From these a plan for all, by repair of what overlaps, one robot at a time (Repair), under
///    a makespan bound from the start; where that stagnates, in turn (FirstPlan,
///    RevisedPrioritizedPlanning).
/// 3. A makespan bound is tightened towards the lower bound; whoever is late is planned anew
///    and the rest repaired.
/// 4. At the makespan found, robots arrive earlier where they can: the sum of costs.
///
/// Always continuous in its collision rule. Steps are shorter than the instance's: see
/// PlannerResult::dt. Budgets are in expansions: equal seeds and threads give equal plans, unless
/// the deadline ends the search. Source of the repair: LNS2, Li et al. 2022.
[[nodiscard]] PlannerResult solve_escot_star(const PlanningProblem& problem,
                                             const EscotStarOptions& options,
                                             const Deadline& deadline);

}  // namespace mvtp
