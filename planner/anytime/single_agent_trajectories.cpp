#include "planner/anytime/single_agent_trajectories.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "planner/escot/single_agent_path.hpp"

namespace mvtp {
namespace {

constexpr double kWeight = 2.0;  ///< they need only be good reference paths
constexpr int kExpansions = 500;
constexpr int kFinerLevels = 3;  ///< of searches with smaller cells where that finds none
constexpr int kFactor = 8;       ///< each has so many times the expansions of the one before

std::optional<ArcTrajectory> find_path_alone(SoftHybridAstar& search,
                                             const PlanningProblem& problem, int i,
                                             const MacroRobot& robot, const Deadline& deadline) {
  std::optional<ArcTrajectory> trajectory =
      find_single_agent_trajectory(search, robot, kWeight, kExpansions, 0, deadline);
  if (trajectory) return trajectory;
  if (const std::optional<std::vector<Arc>> arcs = find_single_agent_path(problem, i, deadline)) {
    return ArcTrajectory(robot.car->vehicle(), robot.start,
                         by_time_steps(*arcs, robot.car->step_length()),
                         robot.car->time().macro_step);
  }
  int expansions = kExpansions;
  for (int finer = 1; finer <= kFinerLevels && !trajectory && !deadline.expired(); ++finer) {
    expansions *= kFactor;
    trajectory = find_single_agent_trajectory(search, robot, kWeight, expansions, finer, deadline);
  }
  return trajectory;
}

}  // namespace

std::optional<ArcTrajectory> find_single_agent_trajectory(SoftHybridAstar& search,
                                                          const MacroRobot& robot, double weight,
                                                          int expansions, int finer,
                                                          const Deadline& deadline) {
  const TimeGrid& time = robot.car->time();
  const Occupancy nobody(1, time);
  SoftProblem alone;
  alone.car = robot.car;
  alone.cost_to_go = robot.cost_to_go;
  alone.others.occupancy = &nobody;
  alone.start = robot.start;
  SoftOptions options;
  options.weight = weight;
  options.max_expansions = expansions;
  options.leave_out_time();
  options.slowly = finer > 0;
  for (int level = 0; level < finer; ++level) options.refine();
  std::optional<SoftResult> path = search.search(alone, options, deadline);
  if (!path) return std::nullopt;
  return ArcTrajectory(robot.car->vehicle(), robot.start, std::move(path->steps), time.macro_step);
}

std::vector<ArcTrajectory> find_single_agent_trajectories(const PlanningProblem& problem,
                                                          const std::vector<MacroRobot>& robots,
                                                          const Deadline& deadline) {
  SoftHybridAstar search(1);
  std::vector<ArcTrajectory> trajectories;
  for (int i = 0; i < problem.size(); ++i) {
    std::optional<ArcTrajectory> trajectory =
        deadline.expired() ? std::nullopt
                           : find_path_alone(search, problem, i, robots[std::size_t(i)], deadline);
    if (!trajectory) return {};
    trajectories.push_back(*std::move(trajectory));
  }
  return trajectories;
}

}  // namespace mvtp
