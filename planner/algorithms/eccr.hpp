#pragma once

#include <optional>
#include <span>
#include <vector>

#include "planner/problem/deadline.hpp"
#include "planner/search/spacetime_hybrid_astar.hpp"

namespace mvtp {

struct EccrRobot {
  const SteppedCar* car = nullptr;
  const CostToGo* cost_to_go = nullptr;  ///< names the goal
  Pose start;
};

struct EccrOptions {
  double w = 1.5;              ///< bound of suboptimality on both levels, >= 1
  int max_nodes = 1000;        ///< of the high level
  int max_expansions = 20000;  ///< of each low-level search
};

/// Why there is no result.
enum class EccrFailure { kNone, kNoPath, kTooManyNodes, kTimeout };

struct EccrResult {
  EccrFailure failure = EccrFailure::kNone;
  std::vector<std::vector<Arc>> steps;  ///< per robot, waits included; empty unless solved
};

/// Enhanced conflict-based search for car-like robots: collision-free ways of all robots to their
/// goals, at most w times as costly as the best that conflict-based search finds.
///
/// The cost of a robot is its arrival time, but no less than the slowest one's cost-to-go: arriving
/// before the makespan can end is worth nothing, so quick robots give way.
/// Two levels of focal search: the high level expands, among the nodes that cost at most w times
/// the least lower bound, one with the fewest conflicts; the low level is SpacetimeHybridAstar.
/// A conflict of i and j at step t splits into "i keeps clear of j's sweep of step t", during
/// t - 1 ... t + 1, and the other way round. The window makes progress in continuous space, and
/// costs completeness, like that of CL-CBS.
/// Source: ESCoT paper Sec. III-E (ECCR, Guo & Yu 2024); Barer et al. 2014; Wen et al. 2022.
///
/// @param others  robots outside the group: collisions with them are avoided where that is cheap.
[[nodiscard]] EccrResult solve_eccr(std::span<const EccrRobot> robots,
                                    std::span<const MovingObstacle* const> others,
                                    const SpacetimeHybridAstar& low_level,
                                    const EccrOptions& options, const Deadline& deadline);

}  // namespace mvtp
