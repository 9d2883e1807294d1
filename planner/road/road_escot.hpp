#pragma once

#include <cstdint>
#include <span>
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

/// One decision of ESCoT over the model `InertialCar`: function GenerateConfig of [ESCoT, Alg. 2].
///
/// GroupRobots: vehicles whose paths may still meet; groups are planned independently, on several
/// threads. GetOptTraj: complete trajectories in a searched order (plan_crossing). The rest of a
/// group: PBCR over accelerations, where those that have a plan are decided robots.
/// Returns something for everybody, in whatever state the vehicles are.
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

  RoadStepWorld(const RoadPairs& pairs, const JointPlan& complete,
                const WholeTrajectoryOptions& options);

  /// Robots are numbered as the scene's vehicles.
  [[nodiscard]] std::vector<Motion> candidates(int i, const State& state) const;
  [[nodiscard]] Motion safe_stop(int i, const State& state) const;
  [[nodiscard]] bool conflict(int i, const Motion& a, int j, const Motion& b) const;
  [[nodiscard]] std::span<const int> near(int i) const { return near_[std::size_t(i)]; }

 private:
  [[nodiscard]] const RoadScene& scene() const { return pairs_.scene(); }
  [[nodiscard]] const RoadVehicle& vehicle(int i) const { return scene().vehicles[std::size_t(i)]; }

  const RoadPairs& pairs_;
  const JointPlan& complete_;
  const WholeTrajectoryOptions& options_;
  std::vector<std::vector<int>> near_;
};

}  // namespace mvtp
