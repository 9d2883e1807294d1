#pragma once

#include <cstddef>

#include "planner/problem/plan.hpp"

namespace mvtp {

/// The step at which the vehicle is at its last pose for good; waits at the end do not count.
[[nodiscard]] std::size_t arrival_step(const Trajectory& trajectory);

/// The step at which the last vehicle has arrived; 0 for an empty plan.
[[nodiscard]] std::size_t makespan_steps(const Plan& plan);

/// The sum over the vehicles of their arrival steps.
[[nodiscard]] std::size_t flowtime_steps(const Plan& plan);

/// Fills in what follows from the trajectories: makespan, makespan_steps, flowtime and cost, with
/// `statistics.dt` seconds per step. The bounds and the run time are the solver's to say:
/// `lower_bound` [s] is the largest over the robots of (Reeds-Shepp length from start to goal) /
/// max_speed, obstacles and the others left out; `solo_makespan` [s] the largest time that a robot
/// needs among the obstacles, the others left out.
void fill_in_durations(Plan& plan);

}  // namespace mvtp
