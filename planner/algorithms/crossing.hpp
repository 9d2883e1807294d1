#pragma once

#include <cstdint>
#include <vector>

#include "planner/algorithms/whole_trajectory.hpp"

namespace mvtp {

struct CrossingOptions {
  WholeTrajectoryOptions trajectory;
  int tries = 10;               ///< orders tried per call; 0: the order of arrival
  int repairs = 30;             ///< times that a vehicle without a plan is moved to the front
  double headway_weight = 3.0;  ///< [s/s] cost of a headway that is missing at hand-back
};

struct CrossingResult {
  JointPlan plan;                       ///< complete trajectories of all but `unplanned`
  std::vector<std::int64_t> unplanned;  ///< in the order given
  double cost = 0.0;                    ///< [s] of `plan`
};

/// GetOptTraj [ESCoT, Alg. 2 l. 15] on roads: complete trajectories for a group of vehicles,
/// planned one after another in an order of priority, which is searched.
///
/// @param keys  the group; newcomers (without an incumbent) come after the others, as given here.
/// @param incumbent  what the vehicles follow now; its order is where the search starts. The result
///     is never worse than the incumbent with the newcomers planned last.
/// @param seed  of the moves tried. Same arguments, same result.
[[nodiscard]] CrossingResult plan_crossing(const RoadScene& scene,
                                           const std::vector<std::int64_t>& keys,
                                           const JointPlan& incumbent,
                                           const CrossingOptions& options, std::uint64_t seed);

}  // namespace mvtp
