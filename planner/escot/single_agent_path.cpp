#include "planner/escot/single_agent_path.hpp"

#include <utility>

#include "planner/search/spacetime_hybrid_astar.hpp"

namespace mvtp {

std::optional<std::vector<Arc>> find_single_agent_path(const PlanningProblem& fleet, int i,
                                                       const Deadline& deadline) {
  const Instance& instance = fleet.instance();
  const SteppedCar car(fleet.car(i).vehicle(), instance.dt, CollisionRule::kContinuous,
                       instance.map, fleet.obstacles(), fleet.exemptions(i));
  SearchProblem problem;
  problem.car = &car;
  problem.cost_to_go = &fleet.cost_to_go(i);
  problem.start = instance.agents[std::size_t(i)].start;
  std::optional<TimedPath> path =
      SpacetimeHybridAstar(fleet.curves())
          .search_with_shorter_steps(problem, {.w = 1.5, .max_expansions = 20'000}, deadline);
  if (!path) return std::nullopt;
  return std::move(path->steps);
}

bool solvable_alone(const PlanningProblem& fleet, int i) {
  return find_single_agent_path(fleet, i, Deadline::never()).has_value();
}

}  // namespace mvtp
