#include "planner/road/crossing_search.hpp"

#include <algorithm>

namespace mvtp {

CrossingSearch::CrossingSearch(const RoadPairs& of, const CrossingOptions& with, WorkBudget budget)
    : pairs(of),
      scene(of.scene()),
      options(with),
      orders(of),
      cost(of, with.profile, with.headway_weight),
      plans(of, cost, with.profile),
      work(budget) {}

JointPlan CrossingSearch::those_leaving(const JointPlan& plan) const {
  JointPlan found;
  for (const RoadVehicle& v : scene.vehicles) {
    const Entry* e = plan.entry(v.key);
    if (v.leaves() && e != nullptr) found.entries.push_back(*e);
  }
  return found;
}

const JointPlan::Entry* CrossingSearch::fitting_incumbent(std::int64_t key,
                                                          const JointPlan& incumbent,
                                                          std::span<const Entry> before) {
  const Entry* old = incumbent.entry(key);
  const bool fits = old != nullptr && still_fits(pairs, scene.vehicle(key), *old->profile, before,
                                                 options.profile, &work);
  return fits ? old : nullptr;
}

PassingOrder CrossingSearch::keys_of(const std::vector<Entry>& entries) {
  PassingOrder keys;
  for (const Entry& e : entries) keys.push_back(e.key);
  return keys;
}

std::vector<JointPlan::Entry> CrossingSearch::in_lane_order(
    const std::vector<Entry>& entries) const {
  std::vector<Entry> sorted;
  for (const std::int64_t key : orders.in_lane_order(keys_of(entries))) {
    sorted.push_back(*std::ranges::find(entries, key, &Entry::key));
  }
  return sorted;
}

}  // namespace mvtp
