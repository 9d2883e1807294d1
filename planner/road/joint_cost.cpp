#include "planner/road/joint_cost.hpp"

#include <algorithm>
#include <memory>

namespace mvtp {

double JointCost::until_handback(const JointPlan::Entry& e) const {
  const RoadVehicle& v = scene_.vehicle(e.key);
  const std::int64_t k = std::max(scene_.step, arrival_step(*e.profile, v.s_handback));
  const double speed = k < e.profile->end() ? e.profile->at(k).v : v.cruise_speed;
  const double missing = std::max(0.0, v.cruise_speed - speed);
  return v.weight * (double(k - scene_.step) * scene_.grid.dt +
                     missing * missing / (2.0 * scene_.body(v).max_accel * v.cruise_speed));
}

std::vector<double> JointCost::delays(const Entries& entries) {
  std::vector<double> delays;
  for (const JointPlan::Entry& e : entries) {
    delays.push_back(std::max(0.0, until_handback(e) - alone(e.key)));
  }
  return delays;
}

double JointCost::alone(std::int64_t key) {
  const auto [alone, is_new] = alone_.try_emplace(key, 0.0);
  if (is_new) {
    auto run = plan_alone(pairs_, scene_.vehicle(key), options_);
    alone->second = until_handback({key, std::make_shared<SpeedProfile>(std::move(run))});
  }
  return alone->second;
}

double JointCost::of(const Entries& entries) const {
  std::vector<OnExit> all;
  for (const JointPlan::Entry& e : entries) {
    all.push_back({&scene_.vehicle(e.key), e.profile.get()});
  }
  for (const Forecast& f : scene_.forecasts) all.push_back({&f.vehicle, &f.earliest});
  double cost = 0.0;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    cost += until_handback(entries[i]) + headway_weight_ * missing_headway(all[i], all);
  }
  return cost;
}

/// Time headway that the driver who takes over will miss [s].
double JointCost::missing_headway(const OnExit& own, const std::vector<OnExit>& all) const {
  const RoadVehicle& v = *own.vehicle;
  if (v.exit_lane < 0) return 0.0;
  const std::int64_t k = arrival_step(*own.profile, v.s_handback);
  if (k >= own.profile->end()) return 0.0;
  const InertialState state = own.profile->at(k);
  double missing = 0.0;
  for (const auto& [vehicle, profile] : all) {
    const RoadVehicle& o = *vehicle;
    if (o.exit_lane != v.exit_lane) continue;
    const InertialState ahead = profile->at(k);
    const double gap = (ahead.s - o.s_exit_lane) - (state.s - v.s_exit_lane);
    if (gap <= 0.0 || ahead.s >= SpeedProfile::kDeparted) continue;
    const double wanted =
        drivers_gap(v, state.v, scene_.body(v).max_decel, ahead.v, scene_.body(o).max_decel);
    missing += std::max(0.0, wanted - (gap - scene_.body(o).length())) / std::max(1.0, state.v);
  }
  return missing;
}

std::vector<double> JointCost::own_delays(const Entries& entries) {
  constexpr double kShare = 0.05;
  const std::vector<double> all = delays(entries);
  std::vector<double> own = all;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    std::size_t leader = i;
    const std::size_t self = pairs_.index(entries[i].key);
    while (leader > 0 && !pairs_.leads(pairs_.index(entries[leader - 1].key), self)) --leader;
    if (leader == 0) continue;
    own[i] = std::max(kShare * all[i], all[i] - all[leader - 1]);
  }
  return own;
}

}  // namespace mvtp
