// Messages that take their time, and vehicles that are not where their plans have them.
//
// What is decided now takes effect `lead` steps later, when every vehicle has got it; until then
// everybody follows the plan of before, which the new one begins with. So a message that is late or
// lost changes nothing, as long as it gets through within the lead.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coordinator/junctions/tolerate.hpp"

namespace mvtp {

void tolerate(const FaultTolerance& tolerance, const RoadNetwork& network, double step_length,
              CoordinatorOptions& options) {
  options.tolerance = tolerance;
  double fastest = 0.0;
  for (const auto& [id, lane] : network.lanes) {
    if (lane.drivable) fastest = std::max(fastest, lane.speed_limit);
  }
  options.corridors.latency = tolerance.latency(step_length);
  options.corridors.takeover += fastest * options.corridors.latency;
  options.limits.margins.along += tolerance.more.along;
  options.limits.margins.across += tolerance.more.across;
}

/// Until a plan takes effect, and since its report, a newcomer is expected to keep its speed.
void Coordinator::delay(Driven& driven, const VehicleState& v) const {
  InertialState& now = driven.road.now;
  now.s += now.v * v.age;
  for (int i = 0; i < options_.tolerance.lead; ++i) {
    driven.committed.push_back(now);
    now.s += now.v * grid_.dt;
  }
}

/// A vehicle under control is where its plan has it, rather than where it was when it reported.
const VehicleState& Coordinator::believed(const std::string& id, const Driven& driven) {
  const VehicleState& reported = *find_state(id);
  if (options_.tolerance.exact) return reported;
  VehicleState state = reported;
  const PlannedPose planned = planned_pose(driven, here(driven));
  state.pose = planned.pose;
  state.speed = planned.speed;
  state.age = 0.0;
  return believed_[id] = std::move(state);
}

/// Who goes on into another corridor does there what its plan has said so far.
void Coordinator::continue_on(Driven& arrival, const Driven& before) const {
  if (options_.tolerance.exact) return;
  const SpeedProfile& plan = *plan_.find(before.key);
  const double shift = arrival.approach.begin() - here(before).s;
  arrival.since = before.since;
  arrival.past = before.past;
  arrival.committed.clear();
  for (std::int64_t k = step_; k < effective_step(); ++k) {
    const InertialState state = state_at(plan, k);
    arrival.committed.push_back({state.s + shift, state.v});
  }
  arrival.road.now.s = before.road.now.s + shift;
}

/// Puts before each new plan what the vehicle does until it takes effect.
void Coordinator::commit(const std::map<std::string, Driven>& arrivals) {
  const std::int64_t lead = options_.tolerance.lead;
  if (lead == 0) return;
  for (const auto& [id, driven] : driven_) {
    JointPlan::Entry* entry = plan_.entry(driven.key);
    if (entry->profile->begin <= step_) continue;
    auto whole = std::make_shared<SpeedProfile>(*entry->profile);
    const bool arrives = arrivals.contains(id) && !driven.committed.empty();
    std::vector<InertialState> states = driven.committed;
    if (!arrives) {
      const SpeedProfile& before = *executed_.at(driven.key);
      states.clear();
      for (std::int64_t k = step_; k < whole->begin; ++k) states.push_back(state_at(before, k));
    }
    states.insert(states.end(), whole->states.begin(), whole->states.end());
    whole->states = std::move(states);
    whole->begin = step_;
    entry->profile = std::move(whole);
  }
  for (auto& [id, driven] : driven_) driven.committed.clear();
  executed_.clear();
  for (const JointPlan::Entry& e : plan_.entries) executed_.emplace(e.key, e.profile);
}

/// Tells the traffic the plans that are new.
void Coordinator::announce_plans() {
  std::map<std::string, std::shared_ptr<const SpeedProfile>> announced;
  for (const auto& [id, driven] : driven_) {
    const JointPlan::Entry* entry = plan_.entry(driven.key);
    const auto known = announced_.find(id);
    announced.emplace(id, entry->profile);
    if (known != announced_.end() && known->second == entry->profile) continue;
    std::vector<PlannedPose> poses;
    for (std::int64_t k = step_; k < entry->profile->end(); ++k) {
      poses.push_back(planned_pose(driven, entry->profile->at(k)));
    }
    if (poses.empty()) poses.push_back(planned_pose(driven, entry->profile->states.back()));
    traffic_.announce_plan(id, std::move(poses), entry->profile->complete);
  }
  announced_ = std::move(announced);
}

/// Was the vehicle, when it reported, further from its plan than any that obeys?
bool Coordinator::is_lost(const Driven& driven, const VehicleState& state) const {
  constexpr double kUnnoticed = 2.0;     // [m] that nobody minds
  constexpr double kSettling = 10.0;     // [s] after the takeover
  constexpr double kAcceleration = 3.0;  // [m/s^2] by which its driver may have differed until then
  const auto ago = std::size_t(std::lround(state.age / grid_.dt));
  const std::int64_t then = step_ - std::int64_t(ago);
  if (ago >= driven.past.size() || then <= driven.since + options_.tolerance.lead) return false;
  double allowed = kUnnoticed + options_.tolerance.off;
  if (double(then - driven.since) * grid_.dt < kSettling) {
    const double latency = options_.tolerance.latency(grid_.dt);
    allowed += 0.5 * kAcceleration * latency * latency;
  }
  return distance(driven.past[ago], state.pose) > allowed;
}

/// Who does not obey is one more driver of whom nobody knows what he will do.
void Coordinator::give_up_the_lost() {
  std::erase_if(lost_, [&](const std::string& id) {
    return find_state(id) == nullptr || !traffic_.is_taken_over(id);
  });
  std::vector<const VehicleState*> lost;
  for (const auto& [id, driven] : driven_) {
    const VehicleState* state = find_state(id);
    if (is_lost(driven, *state)) lost.push_back(state);
  }
  for (const VehicleState* state : lost) {
    const std::int64_t key = driven_.at(state->id).key;
    std::erase_if(plan_.entries, [&](const auto& e) { return e.key == key; });
    driven_.erase(state->id);
    lost_.insert(state->id);
    losses_.push_back({step_, traffic_.time(), state->id, "is not where its plan has it"});
  }
  if (lost.empty() || driven_.empty() || planner_is_dead()) return;
  follow_plans();
  for (const VehicleState* state : lost) brake_for(*state);
}

/// Forecasts begin when what they rest on was seen; what they are compared with begins later.
void Coordinator::look_ahead(std::vector<Forecast>& forecasts) const {
  std::erase_if(forecasts, [&](Forecast& f) {
    if (f.earliest.begin >= effective_step()) return false;
    InertialState then = f.earliest.at(effective_step());
    if (then.s >= SpeedProfile::kDeparted && f.latest) then = f.latest->at(effective_step());
    f.vehicle.now = then;
    return then.s >= SpeedProfile::kDeparted;
  });
}

}  // namespace mvtp
