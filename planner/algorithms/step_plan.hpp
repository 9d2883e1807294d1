#pragma once

#include <vector>

#include "planner/algorithms/fleet.hpp"
#include "planner/problem/plan.hpp"

namespace mvtp {

/// What an algorithm found: one trajectory per robot if solved, else as far as it came, or none.
struct StepPlan {
  Status status = Status::kExhausted;
  std::vector<Trajectory> trajectories;
};

/// The trajectory of robot i that drives `steps` from its start.
[[nodiscard]] Trajectory trajectory_of(const Fleet& fleet, int i, const std::vector<Arc>& steps);

}  // namespace mvtp
