#pragma once

#include <span>
#include <vector>

#include "planner/problem/deadline.hpp"
#include "planner/search/spacetime_hybrid_astar.hpp"

namespace mvtp {

struct CbsRobot {
  const SteppedCar* car = nullptr;
  const CostToGo* cost_to_go = nullptr;  ///< names the goal
  Pose start;
};

/// What a robot's path costs; the cost of a plan is the sum over its robots.
enum class CbsCost {
  kArrival,         ///< the step in which it arrives
  kLateForSlowest,  ///< the same, but no less than the slowest robot's cost-to-go: arriving before
                    ///< the makespan can end is worth nothing, so quick robots give way
};

struct CbsOptions {
  double w = 1.0;  ///< bound of suboptimality on both levels, >= 1
  CbsCost cost = CbsCost::kArrival;
  int max_nodes = 100'000;       ///< of the high level; about a kilobyte each
  int max_expansions = 200'000;  ///< of each low-level search
  int lookahead =
      TimedObstacles::kForEver;  ///< steps for which robots outside the group are looked at
};

/// CL-CBS: the high level takes the node of least cost. Source: Wen et al. 2022.
[[nodiscard]] inline CbsOptions cl_cbs_options() { return {}; }

/// ECCR: focal search on both levels. Source: ESCoT paper Sec. III-E; Barer et al. 2014.
[[nodiscard]] inline CbsOptions eccr_options() {
  return {.w = 1.5, .cost = CbsCost::kLateForSlowest};
}

/// Why there is no result.
enum class CbsFailure { kNone, kNoPath, kTooManyNodes, kTimeout };

struct CbsResult {
  CbsFailure failure = CbsFailure::kNone;
  std::vector<std::vector<Arc>> steps;  ///< per robot, waits included; empty unless solved
};

/// Conflict-based search with bodies instead of cells: collision-free paths of all robots to their
/// goals, at most w times as costly as the best that such a search finds.
///
/// Two levels of focal search: the high level expands, among the nodes that cost at most w times
/// the least lower bound, one with the fewest conflicts; the low level is SpacetimeHybridAstar.
/// With w = 1 that is best first, ties going to the fewest conflicts.
/// A conflict of i and j at step t splits into "i keeps clear of j's sweep of step t", during
/// t - 1 ... t + 1, and the other way round. The window makes progress in continuous space, and
/// costs completeness, as it does in CL-CBS.
///
/// @param others  robots outside the group: collisions with them are avoided where that is cheap.
[[nodiscard]] CbsResult conflict_based_search(std::span<const CbsRobot> robots,
                                              std::span<const SweptTrajectory* const> others,
                                              const SpacetimeHybridAstar& low_level,
                                              const CbsOptions& options, const Deadline& deadline);

}  // namespace mvtp
