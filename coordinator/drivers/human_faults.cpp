#include "coordinator/drivers/human_faults.hpp"

#include <algorithm>
#include <limits>

namespace mvtp {
namespace {

constexpr double kNearest = 2.0;    ///< [m] before the line where a fault begins at the latest,
constexpr double kFarthest = 60.0;  ///< and at the earliest
constexpr double kStop = 8.0;       ///< [s] of a dead stop
constexpr double kPassage = 15.0;   ///< [s] for which signals or time to react are ignored
constexpr double kReaction = 1.5;   ///< [s]
constexpr int kKinds = 4;

}  // namespace

std::string to_string(HumanFaultKind kind) {
  switch (kind) {
    case HumanFaultKind::kRedRunner:
      return "red-runner";
    case HumanFaultKind::kDeadStop:
      return "dead stop";
    case HumanFaultKind::kSwerve:
      return "sudden lane change";
    case HumanFaultKind::kLateReaction:
      break;
  }
  return "late reaction";
}

HumanFaults::HumanFaults(Traffic& traffic, HumanFaultPort& port, HumanFaultOptions options)
    : traffic_(traffic), port_(port), options_(std::move(options)) {
  for (const std::string& lane : options_.lanes) {
    ends_[lane] = traffic.network().lanes.at(lane).length;
  }
}

/// A number in [0, 1) for each question about a vehicle.
double HumanFaults::draw(const std::string& id, const char* what) const {
  return share_of_id(id + '/' + what, options_.seed);
}

bool HumanFaults::misbehaves(const VehicleState& v) const {
  return !options_.humans.contains(v.id, v.type) && draw(v.id, "fault") < options_.rate;
}

void HumanFaults::decide() {
  for (auto it = ongoing_.begin(); it != ongoing_.end();) {
    const bool over = traffic_.time() >= it->second.end;
    if (over) finish(it->first, it->second.kind);
    it = over ? ongoing_.erase(it) : std::next(it);
  }
  for (const VehicleState& v : traffic_.vehicles()) {
    const auto end = ends_.find(v.lane);
    if (end == ends_.end() || done_.contains(v.id) || !misbehaves(v)) continue;
    const double from = kNearest + draw(v.id, "place") * (kFarthest - kNearest);
    if (end->second - v.lane_position < from) begin(v);
  }
}

void HumanFaults::begin(const VehicleState& v) {
  const auto kind = HumanFaultKind(int(draw(v.id, "kind") * kKinds));
  done_.emplace(v.id, kind);
  faults_.push_back({v.id, kind, traffic_.time()});
  switch (kind) {
    case HumanFaultKind::kRedRunner:
      traffic_.let_through(v.id, Passage::kOneLine);
      break;
    case HumanFaultKind::kDeadStop:
      traffic_.cap_speed(v.id, 0.0);
      break;
    case HumanFaultKind::kSwerve:
      return port_.swerve(v.id);
    case HumanFaultKind::kLateReaction:
      port_.react_late(v.id, kReaction);
      break;
  }
  ongoing_[v.id] = {kind, traffic_.time() + (kind == HumanFaultKind::kDeadStop ? kStop : kPassage)};
}

void HumanFaults::finish(const std::string& id, HumanFaultKind kind) {
  const auto states = traffic_.vehicles();
  const auto there = std::ranges::lower_bound(states, id, {}, &VehicleState::id);
  if (there == states.end() || there->id != id) return;
  if (kind == HumanFaultKind::kRedRunner) traffic_.let_through(id, Passage::kNone);
  if (kind == HumanFaultKind::kDeadStop) {
    traffic_.cap_speed(id, std::numeric_limits<double>::infinity());
  }
  if (kind == HumanFaultKind::kLateReaction) port_.react_late(id, 0.0);
}

}  // namespace mvtp
