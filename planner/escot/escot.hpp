#pragma once

#include <cstdint>

#include "planner/escot/planner_result.hpp"
#include "planner/escot/planning_problem.hpp"
#include "planner/escot/stepped_world.hpp"
#include "planner/problem/deadline.hpp"

namespace mvtp {

struct EscotOptions {
  SteppedWorldOptions world;
  bool replan_duplicates = true;  ///< false, and world.grouping false: PBCR [Algorithm 1]
  std::uint64_t seed = 0;
  int max_steps = 20000;  ///< steps that are planned, those cut out again included
};

/// Plans step by step until every robot is at its goal.
/// Source: ESCoT paper, Algorithm 2 (and Algorithm 1, see EscotOptions).
[[nodiscard]] PlannerResult solve_escot(const PlanningProblem& problem, const EscotOptions& options,
                                        const Deadline& deadline);

}  // namespace mvtp
