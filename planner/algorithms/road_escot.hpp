#pragma once

#include <cstdint>
#include <vector>

#include "planner/algorithms/crossing.hpp"

namespace mvtp {

struct RoadEscotOptions {
  CrossingOptions crossing;
  int max_group = 150;  ///< PreCheck: larger groups keep their plans, newcomers are left to PBCR
  std::uint64_t seed = 0;
};

/// What every vehicle does from this decision on.
struct RoadDecision {
  JointPlan plan;  ///< one trajectory per vehicle of the scene
  int groups = 0;
  int stepped = 0;           ///< vehicles without a complete plan, left to PBCR
  bool all_stepped = false;  ///< not even the complete plans could be kept
  double cost = 0.0;         ///< [s] of the complete plans
};

/// One decision of ESCoT over the model `InertialCar`: function GenerateConfig of [ESCoT, Alg. 2].
///
/// GroupRobots: vehicles whose paths may still meet. PreCheck: the group's size. GetOptTraj:
/// complete trajectories in a searched order (plan_crossing). The rest: PBCR over accelerations,
/// where the vehicles of the groups are decided robots.
///
/// @param order  keys of the vehicles without a trajectory in `incumbent`, the first first.
[[nodiscard]] RoadDecision decide_on_road(const RoadScene& scene, const JointPlan& incumbent,
                                          const std::vector<std::int64_t>& order,
                                          const RoadEscotOptions& options);

/// GroupRobots on roads: connected components of "may still meet on the rest of their paths".
/// Each group ordered by key, the groups by their first.
[[nodiscard]] std::vector<std::vector<std::int64_t>> group_vehicles(const RoadScene& scene);

/// The world of PBCR on roads: a motion is one decision's acceleration and full braking after it.
///
/// Keep-clear: candidates after which a vehicle could not stand clear of the complete plans of
/// others come last, since all-brake alone is safe but ends in gridlock.
class RoadStepWorld {
 public:
  using State = InertialState;
  struct Motion {
    InertialState from;
    double acceleration = 0.0;
    InertialState to;
  };

  RoadStepWorld(const RoadScene& scene, const JointPlan& complete,
                const WholeTrajectoryOptions& options)
      : scene_(scene), complete_(complete), options_(options) {}

  /// Robots are numbered as the scene's vehicles.
  [[nodiscard]] std::vector<Motion> candidates(int i, const State& state) const;
  [[nodiscard]] Motion safe_stop(int i, const State& state) const;
  [[nodiscard]] bool conflict(int i, const Motion& a, int j, const Motion& b) const;

 private:
  [[nodiscard]] const RoadVehicle& vehicle(int i) const { return scene_.vehicles[std::size_t(i)]; }

  const RoadScene& scene_;
  const JointPlan& complete_;
  const WholeTrajectoryOptions& options_;
};

}  // namespace mvtp
