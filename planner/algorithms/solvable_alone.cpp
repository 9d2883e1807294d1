#include "planner/algorithms/solvable_alone.hpp"

#include <utility>

#include "planner/search/spacetime_hybrid_astar.hpp"

namespace mvtp {

std::optional<std::vector<Arc>> find_way_alone(const Fleet& fleet, int i,
                                               const Deadline& deadline) {
  const Instance& instance = fleet.instance();
  const SteppedCar car(fleet.car(i).vehicle(), instance.dt, CollisionRule::kContinuous,
                       instance.map, fleet.obstacles());
  SearchProblem problem;
  problem.car = &car;
  problem.cost_to_go = &fleet.cost_to_go(i);
  problem.start = instance.agents[std::size_t(i)].start;
  const SpacetimeHybridAstar planner(fleet.curves());
  // Full steps do not get out of every narrow place; shorter ones may.
  for (const double scale : {1.0, 0.5, 0.25}) {
    const SearchOptions options{.w = 1.5, .max_expansions = 20'000, .arc_scale = scale};
    std::optional<TimedPath> path = planner.search(problem, options, deadline);
    if (path) return std::move(path->steps);
  }
  return std::nullopt;
}

bool solvable_alone(const Fleet& fleet, int i) {
  return find_way_alone(fleet, i, Deadline::never()).has_value();
}

}  // namespace mvtp
