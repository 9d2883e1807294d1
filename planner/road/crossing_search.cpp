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
  if (old == nullptr) return nullptr;
  const RoadVehicle& v = scene.vehicle(key);
  const SpeedProfile& profile = *old->profile;
  if (still_fits(pairs, v, profile, before, options.profile, &work)) return old;
  const std::vector<bool>& beside = waived_for(v, profile);
  if (std::ranges::find(beside, true) == beside.end()) return nullptr;
  return still_fits(pairs, v, profile, before, options.profile, &work, beside) ? old : nullptr;
}

namespace {

/// Do the bodies stay apart while the vehicle follows `profile` and the driver does what is
/// expected, at the looks and between them?
bool stay_apart(const RoadScene& scene, const RoadVehicle& v, const SpeedProfile& profile,
                const RoadVehicle& driver, const SpeedProfile& expected) {
  constexpr double kLeast = 0.1;  // [m]
  constexpr int kParts = 3;       // of a step that are looked at
  const auto body_at = [&](const RoadVehicle& of, const SpeedProfile& motion, std::int64_t k,
                           double share) {
    const double from = motion.at(k).s;
    const double to = std::max(from, motion.at(k + 1).s);
    return footprint(scene.body(of), scene.library->path(of.path).at(from + share * (to - from)));
  };
  for (std::int64_t k = scene.step; k + 1 < profile.end(); ++k) {
    if (expected.at(k + 1).s >= SpeedProfile::kDeparted) return true;
    for (int part = 0; part < kParts; ++part) {
      const double share = double(part) / kParts;
      const double room =
          separation(body_at(v, profile, k, share), body_at(driver, expected, k, share));
      if (room < kLeast) return false;
    }
  }
  return true;
}

}  // namespace

const std::vector<bool>& CrossingSearch::waived_for(const RoadVehicle& v,
                                                    const SpeedProfile& profile) {
  const auto [known, is_new] = waived.try_emplace(v.key);
  std::vector<bool>& beside = known->second;
  const double rest = v.now.s + stopping_distance(v.now.v, scene.body(v).max_decel);
  if (!is_new || v.may_wait_at(rest)) return beside;
  for (const Forecast& f : scene.forecasts) {
    const SpeedProfile& expected = f.held ? *f.held : f.earliest;
    beside.push_back(f.told == Told::kToWait && !f.latest &&
                     stay_apart(scene, v, profile, f.vehicle, expected));
  }
  return beside;
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
