#include "planner/escot/single_agent_path.hpp"

#include <utility>

#include "planner/search/spacetime_hybrid_astar.hpp"

namespace mvtp {

std::optional<std::vector<Arc>> find_single_agent_path(const PlanningProblem& planning_problem,
                                                       int i, const Deadline& deadline) {
  const Instance& instance = planning_problem.instance();
  const SteppedCar car(planning_problem.car(i).vehicle(), instance.dt, CollisionRule::kContinuous,
                       instance.map, planning_problem.obstacles(), planning_problem.exemptions(i));
  SearchProblem problem;
  problem.car = &car;
  problem.cost_to_go = &planning_problem.cost_to_go(i);
  problem.start = instance.agents[std::size_t(i)].start;
  std::optional<SearchResult> path =
      SpacetimeHybridAstar(planning_problem.curves())
          .search_with_shorter_steps(problem, {.w = 1.5, .max_expansions = 20'000}, deadline);
  if (!path) return std::nullopt;
  return std::move(path->steps);
}

}  // namespace mvtp
