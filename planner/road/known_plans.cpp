#include "planner/road/known_plans.hpp"

#include <algorithm>

namespace mvtp {

KnownPlans::Plan KnownPlans::plan(const RoadVehicle& vehicle,
                                  std::span<const JointPlan::Entry> before,
                                  const PlanLimits& limits) {
  std::pair question(vehicle.key, those_met(vehicle, before));
  const auto known = known_.find(question);
  if (known != known_.end()) {
    const Plan& plan = known->second.plan;
    if (plan) {
      const double cost = cost_.until_handback({vehicle.key, plan}) / vehicle.weight;
      return cost < limits.cost ? plan : nullptr;
    }
    if (limits.cost <= known->second.limit) return nullptr;
  }
  auto found = plan_vehicle(pairs_, vehicle, before, options_, limits);
  const Plan plan = found ? unique(vehicle.key, *std::move(found)) : nullptr;
  // A search that ran out of work might have found another one.
  if (limits.work->left > 0) {
    known_.insert_or_assign(std::move(question), Known{plan, limits.cost});
  }
  return plan;
}

KnownPlans::Before KnownPlans::those_met(const RoadVehicle& vehicle,
                                         std::span<const JointPlan::Entry> before) const {
  Before met;
  const std::size_t self = pairs_.index(vehicle.key);
  for (const JointPlan::Entry& e : before) {
    if (e.key == vehicle.key || !pairs_.matters(pairs_.index(e.key), self)) continue;
    met.push_back(e.profile);
  }
  std::ranges::sort(met);
  return met;
}

KnownPlans::Plan KnownPlans::unique(std::int64_t key, SpeedProfile plan) {
  std::vector<Plan>& motions = motions_[key];
  const auto known = std::ranges::find_if(
      motions, [&](const Plan& p) { return p->begin == plan.begin && p->states == plan.states; });
  if (known != motions.end()) return *known;
  return motions.emplace_back(std::make_shared<SpeedProfile>(std::move(plan)));
}

}  // namespace mvtp
