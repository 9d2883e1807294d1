#pragma once

#include <cstdint>
#include <vector>

#include "planner/road/crossing.hpp"

namespace mvtp {

struct RoadEscotOptions {
  CrossingOptions crossing;
  /// Looks at one other vehicle during one decision that a group may take per call; see WorkBudget.
  std::int64_t work = 4'000'000;
  int threads = 0;  ///< for groups; 0: as many as there are cores. Same result for any number
  std::uint64_t seed = 0;
};

/// What every vehicle does from this decision on.
struct RoadDecision {
  JointPlan plan;  ///< one trajectory per vehicle of the scene
  /// Keys of vehicles that have nothing to do with those of other groups.
  std::vector<std::vector<std::int64_t>> members;
  int groups = 0;
  int stepped = 0;           ///< vehicles without a complete plan, left to PBCR
  bool all_stepped = false;  ///< of some group not even the complete plans could be kept
  double cost = 0.0;         ///< [s] of the complete plans
};

/// One decision of ESCoT over the model `InertialCar`: generate_config() over a RoadWorld for each
/// group of vehicles whose paths may still meet. Groups are planned independently, on several
/// threads. Returns something for everybody, in whatever state the vehicles are.
///
/// @param order  keys of the vehicles without a trajectory in `incumbent`, the first first.
[[nodiscard]] RoadDecision decide_on_road(const RoadScene& scene, const JointPlan& incumbent,
                                          const std::vector<std::int64_t>& order,
                                          const RoadEscotOptions& options);

/// GroupRobots on roads: connected components of "may still meet on the rest of their paths".
/// Each group ordered by key, the groups by their first.
[[nodiscard]] std::vector<std::vector<std::int64_t>> group_vehicles(const RoadScene& scene);

}  // namespace mvtp
