#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "planner/road/joint_cost.hpp"

namespace mvtp {

/// Plans of single vehicles in one scene, each found once.
///
/// A plan depends on which plans were made before it, not on their order, and only on those of
/// vehicles that it may meet: two orders of priority that a search tries have most of them in
/// common.
class KnownPlans {
 public:
  using Plan = std::shared_ptr<const SpeedProfile>;

  /// All must outlive this.
  KnownPlans(const RoadPairs& pairs, const JointCost& cost, const ProfileOptions& options)
      : pairs_(pairs), cost_(cost), options_(options) {}

  /// As plan_vehicle(); nullptr if it finds no complete plan. What is known takes no work.
  /// @param limits  with work.
  [[nodiscard]] Plan plan(const RoadVehicle& vehicle, std::span<const JointPlan::Entry> before,
                          const PlanLimits& limits);

 private:
  using Before = std::vector<Plan>;  ///< ascending addresses
  struct Known {
    Plan plan;     ///< nullptr: there is none
    double limit;  ///< [s] at less than this cost
  };

  [[nodiscard]] Before those_met(const RoadVehicle& vehicle,
                                 std::span<const JointPlan::Entry> before) const;
  /// The same motion has one address.
  [[nodiscard]] Plan unique(std::int64_t key, SpeedProfile plan);

  const RoadPairs& pairs_;
  const JointCost& cost_;
  const ProfileOptions& options_;
  std::map<std::pair<std::int64_t, Before>, Known> known_;
  std::map<std::int64_t, std::vector<Plan>> motions_;  ///< by key
};

}  // namespace mvtp
