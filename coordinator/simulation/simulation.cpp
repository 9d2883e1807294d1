#include "coordinator/simulation/simulation.hpp"

#include <algorithm>

namespace mvtp {
namespace {

constexpr double kMoving = 0.1;         ///< [m/s]
constexpr double kLookAtPending = 1.0;  ///< [s] between two looks

}  // namespace

std::string to_string(RunStatus status) {
  switch (status) {
    case RunStatus::kFinished:
      return "finished";
    case RunStatus::kEndReached:
      return "end reached";
    case RunStatus::kInterrupted:
      return "interrupted";
    case RunStatus::kStuck:
      return "stuck";
    case RunStatus::kFailed:
      break;
  }
  return "failed";
}

void Simulation::step() {
  for (Controller* controller : controllers_) controller->decide();
  for (Controller* controller : controllers_) controller->act();
  traffic_.step();
  for (Controller* controller : controllers_) controller->observe();
  const Snapshot now = look();
  if (is_alive(now)) last_motion_ = now.time;
  for (const Observer& observe : observers_) observe(now);
}

std::optional<RunStatus> Simulation::end_by(const RunLimits& limits) const {
  if (!traffic_.running()) return RunStatus::kFinished;
  if (limits.interrupted()) return RunStatus::kInterrupted;
  if (limits.end && traffic_.time() >= *limits.end) return RunStatus::kEndReached;
  if (traffic_.time() - last_motion_ > limits.stuck_after) return RunStatus::kStuck;
  return std::nullopt;
}

RunStatus Simulation::run(const RunLimits& limits) {
  while (true) {
    if (const std::optional<RunStatus> end = end_by(limits)) return *end;
    step();
  }
}

const VehicleType& Simulation::type_of(const std::string& id) {
  const auto known = types_.find(id);
  return known != types_.end() ? known->second
                               : types_.emplace(id, traffic_.type(id)).first->second;
}

Snapshot Simulation::look() {
  sightings_.clear();
  resting_.clear();
  for (const VehicleState& v : traffic_.vehicles()) {
    const bool ours = std::ranges::any_of(controllers_, [&](auto* c) { return c->drives(v.id); });
    const bool rests = v.halted_by_stop ||
                       std::ranges::any_of(controllers_, [&](auto* c) { return c->rests(v.id); });
    sightings_.push_back({&v, &type_of(v.type), ours});
    resting_.push_back(rests ? 1 : 0);
  }
  const double time = traffic_.time();
  if (time >= next_look_at_pending_) {
    pending_ = traffic_.pending();
    next_look_at_pending_ = time + kLookAtPending;
  }
  return {time, sightings_, resting_, traffic_.pedestrians(), pending_};
}

bool Simulation::is_alive(const Snapshot& now) {
  if (now.vehicles.empty()) return now.pending.empty();
  if (std::ranges::find(now.resting, 0) == now.resting.end()) return true;
  return std::ranges::any_of(now.vehicles, [](const Observation& s) {
    return s.state->speed > kMoving || s.state->halted_by_stop;  // others may wait behind it
  });
}

}  // namespace mvtp
