#include "planner/algorithms/solvable_alone.hpp"

#include <algorithm>
#include <array>

#include "planner/search/spacetime_hybrid_astar.hpp"

namespace mvtp {

bool solvable_alone(const Fleet& fleet, int i) {
  SearchProblem problem;
  problem.car = &fleet.car(i);
  problem.cost_to_go = &fleet.cost_to_go(i);
  problem.start = fleet.instance().agents[std::size_t(i)].start;
  const SpacetimeHybridAstar planner(fleet.curves());
  // Full steps do not get out of every narrow place; shorter ones may.
  return std::ranges::any_of(std::array{1.0, 0.5, 0.25}, [&](double scale) {
    const SearchOptions options{.w = 1.5, .max_expansions = 20'000, .arc_scale = scale};
    return planner.search(problem, options, Deadline::never()).has_value();
  });
}

}  // namespace mvtp
