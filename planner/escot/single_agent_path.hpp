#pragma once

#include <optional>
#include <vector>

#include "planner/escot/planning_problem.hpp"

namespace mvtp {

/// A motion that takes robot i from its start to its goal among the obstacles, the other robots
/// absent: arcs of a step or less, free all along under either collision rule.
///
/// @return nullopt if hybrid A* found none within its budget, with steps of any of three lengths,
///         or until the deadline
[[nodiscard]] std::optional<std::vector<Arc>> find_single_agent_path(const PlanningProblem& problem,
                                                                     int i,
                                                                     const Deadline& deadline);

}  // namespace mvtp
