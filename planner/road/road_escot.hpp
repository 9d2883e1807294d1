#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "planner/road/crossing.hpp"

namespace mvtp {

/// The clock's last resort, beside the work that is counted: after half of this time a group's
/// search ends with the best plan so far; a group that takes longer than all of it is late. As long
/// as neither happens, the clock changes nothing.
struct GroupBudget {
  double ms = std::numeric_limits<double>::infinity();
  /// [ms] since any time, of the thread that asks; none: its processor time.
  std::function<double()> clock;
};

struct RoadEscotOptions {
  CrossingOptions crossing;
  /// PreCheck; false: PBCR decides every motion of everybody, and nobody has a complete plan.
  bool plans_groups = true;
  GroupBudget budget;
  /// Looks at one other vehicle during one decision that a group may take per call; see WorkBudget.
  std::int64_t work = 4'000'000;
  int threads = 0;  ///< for groups; 0: as many as there are cores. Same result for any number
  /// Pairs of vehicles, in groups beside the largest, from which other threads are woken. >= 0
  int pairs_for_threads = 200;
  std::uint64_t seed = 0;
};

/// What every vehicle does from this decision on.
struct RoadDecision {
  JointPlan plan;  ///< one profile per vehicle of the scene
  /// Keys of vehicles that have nothing to do with those of other groups.
  std::vector<std::vector<std::int64_t>> members;
  std::vector<std::size_t> late;  ///< groups that took longer than their budget, ascending
  int groups = 0;
  int stepped = 0;            ///< vehicles without a complete plan, left to PBCR
  bool all_stepped = false;   ///< of some group not even the complete plans could be kept
  double cost = 0.0;          ///< [s] of the complete plans
  std::vector<double> costs;  ///< the same of each group
};

/// One decision of ESCoT over the model `InertialCar`: generate_config() over a RoadWorld for each
/// group of vehicles whose paths may still meet. Groups are planned independently, on several
/// threads. Returns something for everybody, in whatever state the vehicles are.
///
/// @param order  keys of the vehicles without a profile in `incumbent`, the first first.
[[nodiscard]] RoadDecision decide_on_road(const RoadScene& scene, const JointPlan& incumbent,
                                          const std::vector<std::int64_t>& order,
                                          const RoadEscotOptions& options);

/// GroupRobots on roads: connected components of "may still meet on the rest of their paths".
/// Each group ordered by key, the groups by their first.
[[nodiscard]] std::vector<std::vector<std::int64_t>> group_vehicles(const RoadScene& scene);

}  // namespace mvtp
