#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "planner/road/crossing.hpp"
#include "planner/road/joint_cost.hpp"
#include "planner/road/known_plans.hpp"
#include "planner/road/passing_order.hpp"

namespace mvtp {

/// What the search for plans of one group works with, from the first complete ones to better ones.
struct CrossingSearch {
  using Entry = JointPlan::Entry;

  /// @param pairs, options  must outlive it.
  CrossingSearch(const RoadPairs& pairs, const CrossingOptions& options, WorkBudget work);

  /// Those of `plan` that are not changed to make room for others.
  [[nodiscard]] JointPlan those_leaving(const JointPlan& plan) const;
  /// The incumbent of a vehicle if it still fits among those planned `before`; else nullptr.
  [[nodiscard]] const Entry* fitting_incumbent(std::int64_t key, const JointPlan& incumbent,
                                               std::span<const Entry> before);
  /// Of a vehicle that cannot stop any more where it may stand: forecasts of drivers who wait
  /// beside `profile`, margins or not. Who stopped on the junction beside one would wait for him,
  /// and he for it.
  [[nodiscard]] const std::vector<bool>& waived_for(const RoadVehicle& vehicle,
                                                    const SpeedProfile& profile);
  [[nodiscard]] static PassingOrder keys_of(const std::vector<Entry>& entries);
  [[nodiscard]] std::vector<Entry> in_lane_order(const std::vector<Entry>& entries) const;

  const RoadPairs& pairs;
  const RoadScene& scene;
  const CrossingOptions& options;
  PassingOrders orders;
  JointCost cost;
  KnownPlans plans;
  WorkBudget work;
  JointPlan leaving;                                 ///< see those_leaving()
  std::map<std::int64_t, std::vector<bool>> waived;  ///< by key, see waived_for()
};

}  // namespace mvtp
