#pragma once

#include <optional>
#include <span>
#include <vector>

#include "planner/motion/cost_to_go.hpp"
#include "planner/motion/reeds_shepp.hpp"
#include "planner/motion/stepped_car.hpp"
#include "planner/problem/deadline.hpp"
#include "planner/search/timed_obstacles.hpp"

namespace mvtp {

/// During the steps first ... last the robot must keep clear of `sweep`.
struct Constraint {
  int first = 0;
  int last = 0;
  Sweep sweep;
};

/// One robot's path to its goal, among static obstacles and others that move.
struct SearchProblem {
  const SteppedCar* car = nullptr;
  const CostToGo* cost_to_go = nullptr;  ///< names the goal
  Pose start;
  std::span<const Constraint> constraints;           ///< must be kept
  const TimedObstacles* to_keep_clear_of = nullptr;  ///< may not be touched; nullptr: nobody
  std::span<const TimedObstacles* const> to_avoid;   ///< collisions are counted, and kept few
  /// Arriving earlier than this is worth nothing: no path costs less [steps]. The slowest robot's
  /// cost-to-go makes room for the quick ones to wait, or to leave their goals and come back.
  double least_cost = 0.0;
};

struct SearchOptions {
  double w = 1.5;             ///< bound of suboptimality, >= 1; the cost-to-go is nearly a bound
  int max_expansions = 5000;  ///< > 0; after so many the best path so far must do
  double arc_scale = 1.0;     ///< drives arcs of this part of a full step, in (0, 1]
};

/// What the search found: one arc per step, waits included, that end exactly at the goal.
struct SearchResult {
  std::vector<Arc> steps;
  double cost = 0.0;         ///< its steps, or least_cost if that is more
  double lower_bound = 0.0;  ///< nearly: cost <= w * lower_bound, unless out of expansions
  int conflicts = 0;         ///< (robot, step) collisions with `to_avoid`
};

/// Focal hybrid A* in (x, y, theta, t) with Reeds-Shepp analytic expansions to the goal.
///
/// Nodes are rated by f, the number of steps until arrival, rounded up to whole steps, for a last
/// arc however short takes a step. FOCAL holds those with f <= w * min f; the fewest conflicts
/// are expanded first. Without anything that moves, time is left out of the state and this is
/// weighted hybrid A*. After its arrival a robot stays: whoever comes by later counts.
/// Source: ESCoT paper Sec. III-E (ECCR's low level); Dolgov et al. 2010; Barer et al. 2014.
class SpacetimeHybridAstar {
 public:
  explicit SpacetimeHybridAstar(const ReedsShepp& curves) : curves_(curves) {}

  /// @return nullopt if no path was found in `max_expansions` or until the deadline, or if there is
  ///         none on the search grid.
  [[nodiscard]] std::optional<SearchResult> search(const SearchProblem& problem,
                                                   const SearchOptions& options,
                                                   const Deadline& deadline) const;

  /// The same, where that fails with steps of half and then a quarter of the length: full steps do
  /// not get out of every narrow place, shorter ones may.
  [[nodiscard]] std::optional<SearchResult> search_with_shorter_steps(
      const SearchProblem& problem, SearchOptions options, const Deadline& deadline) const;

 private:
  const ReedsShepp& curves_;
};

}  // namespace mvtp
