#include "planner/problem/metrics.hpp"

#include <algorithm>

namespace mvtp {

std::size_t arrival_step(const Trajectory& trajectory) {
  const Pose& last = trajectory.waypoints().back().pose;
  std::size_t step = trajectory.makespan();
  while (step > 0 && trajectory.at(step - 1).pose == last) --step;
  return step;
}

std::size_t makespan_steps(const Plan& plan) {
  std::size_t steps = 0;
  for (const Trajectory& trajectory : plan.trajectories) {
    steps = std::max(steps, arrival_step(trajectory));
  }
  return steps;
}

std::size_t flowtime_steps(const Plan& plan) {
  std::size_t steps = 0;
  for (const Trajectory& trajectory : plan.trajectories) steps += arrival_step(trajectory);
  return steps;
}

void fill_in_durations(Plan& plan) {
  Statistics& statistics = plan.statistics;
  statistics.makespan_steps = makespan_steps(plan);
  statistics.makespan = static_cast<double>(statistics.makespan_steps) * statistics.dt;
  statistics.flowtime = static_cast<double>(flowtime_steps(plan)) * statistics.dt;
  statistics.cost = statistics.flowtime;
}

}  // namespace mvtp
