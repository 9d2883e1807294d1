#pragma once

#include <optional>
#include <vector>

#include "planner/escot/planning_problem.hpp"
#include "planner/problem/plan.hpp"

namespace mvtp {

/// What an algorithm found: one trajectory per robot if solved, else as far as it came, or none.
struct PlannerResult {
  Status status = Status::kExhausted;
  std::vector<Trajectory> trajectories;
  std::optional<double> dt = std::nullopt;  ///< of one step [s], if it is not the instance's
  std::optional<double> first_solution = std::nullopt;  ///< [s] after the algorithm was called
  std::optional<double> solo_makespan = std::nullopt;   ///< [s]
};

/// The trajectory of robot i that drives `steps` of `dt` [s] each from its start.
[[nodiscard]] Trajectory trajectory_of(const PlanningProblem& problem, int i,
                                       const std::vector<Arc>& steps, double dt);

}  // namespace mvtp
