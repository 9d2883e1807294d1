#include "traci_bridge/sumo_drivers.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {
namespace {

// Safe speed, acceleration and braking as ever, but no right of way, no signal, no foe inside.
constexpr int kHeedNobody = 39;
constexpr int kHeedSignals = 39 + 16;  ///< the same, but signals
constexpr int kOwnSpeedMode = 31;
// No lane change but those that avoid a collision, which are none where nobody changes.
constexpr int kKeepLane = 512;
constexpr double kSwerve = 1.0;  ///< [s] for which a swerving driver stays on his new lane
/// A vehicle that was just handed back first finds its place in its lane [s]; SUMO changes lanes at
/// once, 3 m aside, where its sublane model is off.
constexpr double kNoLaneChange = 1.0;
constexpr double kOwnSpeed = -1.0;  // TraCI: the driver's choice again

/// Does its lane end at a signal?
bool comes_to_signal(const std::string& id) {
  constexpr double kRounding = 1.0;  // [m]
  const auto signals = api::Vehicle::getNextTLS(id);
  const std::string lane = api::Vehicle::getLaneID(id);
  if (signals.empty() || lane.empty()) return false;
  const double to_end = api::Lane::getLength(lane) - api::Vehicle::getLanePosition(id);
  return signals.front().dist <= to_end + kRounding;
}

}  // namespace

void SumoDrivers::let_through(const std::string& id, Passage passage) {
  int mode = kOwnSpeedMode;
  if (passage == Passage::kAll) mode = kHeedNobody;
  if (passage == Passage::kOneLine) mode = comes_to_signal(id) ? kHeedNobody : kHeedSignals;
  api::Vehicle::setSpeedMode(id, mode);
}

void SumoDrivers::rely_on_signal(const std::string& id, const std::vector<std::string>& waiting) {
  std::string words;
  for (const std::string& other : waiting) words += (words.empty() ? "" : " ") + other;
  api::Vehicle::setParameter(id, "junctionModel.ignoreIDs", words);
  if (waiting.empty()) {
    relying_.erase(id);
  } else {
    relying_.insert(id);
  }
}

void SumoDrivers::keep_lane(const std::string& id, bool keep) {
  if (keep) {
    lane_keepers_[id] = take_lane_change_mode(id);
    api::Vehicle::setLaneChangeMode(id, kKeepLane);
  } else {
    api::Vehicle::setLaneChangeMode(id, lane_keepers_.extract(id).mapped());
  }
}

void SumoDrivers::swap_lanes(const std::string& id, const std::string& other) {
  const std::string lane = api::Vehicle::getLaneID(id);
  const double position = api::Vehicle::getLanePosition(id);
  const std::string lane_beside = api::Vehicle::getLaneID(other);
  const double position_beside = api::Vehicle::getLanePosition(other);
  api::Vehicle::moveTo(id, lane_beside, position_beside);
  api::Vehicle::moveTo(other, lane, position);
}

void SumoDrivers::swerve(const std::string& id) {
  const int lane = api::Vehicle::getLaneIndex(id);
  const int lanes = api::Edge::getLaneNumber(api::Vehicle::getRoadID(id));
  const int beside = lane + 1 < lanes ? lane + 1 : lane - 1;
  if (beside < 0) return;
  api::Vehicle::setLaneChangeMode(id, kObey);
  api::Vehicle::changeLane(id, beside, kSwerve);
}

void SumoDrivers::react_late(const std::string& id, double seconds) {
  api::Vehicle::setActionStepLength(id, seconds);
}

void SumoDrivers::cap_speed(const std::string& id, double speed) {
  const bool slower = speed < api::Vehicle::getAllowedSpeed(id);
  const bool was_slower = caps_.erase(id) > 0;
  if (slower) caps_.emplace(id, speed);
  if (stands_still(id) || (!slower && !was_slower)) return;
  api::Vehicle::setSpeed(id, slower ? speed : kOwnSpeed);
}

void SumoDrivers::stand_still(const std::string& id, bool stand) {
  const auto cap = caps_.find(id);
  api::Vehicle::setSpeed(id, stand ? 0.0 : cap != caps_.end() ? cap->second : kOwnSpeed);
  stand ? (void)still_.insert(id) : (void)still_.erase(id);
}

int SumoDrivers::own_speed_mode(const std::string& id) {
  const int mode = api::Vehicle::getSpeedMode(id);
  return mode == kHeedNobody || mode == kHeedSignals ? kOwnSpeedMode : mode;
}

int SumoDrivers::take_lane_change_mode(const std::string& id) {
  const auto pending = lane_changes_.extract(id);
  return pending ? pending.mapped().mode : api::Vehicle::getLaneChangeMode(id);
}

void SumoDrivers::change_lanes_again(const std::string& id, int mode, double now) {
  lane_changes_[id] = {now + kNoLaneChange, mode};
}

void SumoDrivers::resume_lane_changes(double now) {
  std::erase_if(lane_changes_, [&](const auto& entry) {
    const auto& [id, resumption] = entry;
    if (now < resumption.time) return false;
    api::Vehicle::setLaneChangeMode(id, resumption.mode);
    return true;
  });
}

void SumoDrivers::forget_if(const std::function<bool(const std::string&)>& has_left) {
  const auto entry_has_left = [&](const auto& entry) { return has_left(entry.first); };
  std::erase_if(caps_, entry_has_left);
  std::erase_if(still_, has_left);
  std::erase_if(lane_changes_, entry_has_left);
  std::erase_if(relying_, has_left);
  std::erase_if(lane_keepers_, entry_has_left);
}

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
