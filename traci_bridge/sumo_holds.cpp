#include "traci_bridge/sumo_holds.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "planner/road.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {
namespace {

constexpr double kHoldGap = 1.0;     // from a held vehicle's front to the end of its lane [m]
constexpr double kLeastRoom = 0.02;  // [m] between its front and where it is held
constexpr double kForever = 1.0e6;   // [s]
constexpr double kStands = 0.1;      // [m/s] and slower

/// The lane of its edge, the nearest to its own, from which its route goes on: there it can wait.
std::string lane_to_wait_in(const std::string& id) {
  std::string nearest = api::Vehicle::getLaneID(id);
  int least = std::numeric_limits<int>::max();
  const int here = api::Vehicle::getLaneIndex(id);
  int index = 0;
  for (const auto& lane : api::Vehicle::getBestLanes(id)) {
    const int away = std::abs(index++ - here);
    if (!lane.allowsContinuation || away >= least) continue;
    least = away;
    nearest = lane.laneID;
  }
  return nearest;
}

/// How far a vehicle may still come that is about to speed up [m]: a stop that is nearer it may
/// pass.
double room_to_stop(const std::string& id) {
  const double v =
      api::Vehicle::getSpeed(id) + api::Vehicle::getAccel(id) * api::Simulation::getDeltaT();
  return v * api::Simulation::getDeltaT() + stopping_distance(v, api::Vehicle::getDecel(id));
}

}  // namespace

void SumoHolds::hold(const std::string& id) {
  const std::string here_lane = api::Vehicle::getLaneID(id);
  if (here_lane.empty() || network_.lanes.at(here_lane).internal) return;
  const std::string lane = lane_to_wait_in(id);
  const double length = network_.lanes.at(lane).length;
  const double nearest = api::Vehicle::getLanePosition(id) + room_to_stop(id) + kLeastRoom;
  if (nearest > length) {  // too close to brake: it goes on, unless it stands
    if (api::Vehicle::getSpeed(id) < kStands) drivers_.stand_still(id, true);
    return;
  }
  const Stop stop{.edge = network_.lanes.at(lane).edge,
                  .lane = network_.lanes.at(lane).index,
                  .position = std::max(length - kHoldGap, nearest)};
  try {
    api::Vehicle::setStop(id, stop.edge, stop.position, stop.lane, kForever);
    stops_[id] = stop;
  } catch (const libsumo::TraCIException&) {
    static_cast<void>(log_.take_errors());  // likewise, as SUMO sees it
  }
}

bool SumoHolds::is_at_stop(const std::string& id) {
  constexpr int kStoppedBit = 1;
  return (api::Vehicle::getStopState(id) & kStoppedBit) != 0;
}

void SumoHolds::forget_if_passed(const std::string& id) {
  const auto found = stops_.find(id);
  if (found != stops_.end() && api::Vehicle::getRoadID(id) != found->second.edge) {
    stops_.erase(found);
  }
}

void SumoHolds::release(const std::string& id) {
  if (drivers_.stands_still(id)) return drivers_.stand_still(id, false);
  const auto found = stops_.find(id);
  const Stop& stop = found->second;
  if (is_at_stop(id)) {
    api::Vehicle::resume(id);
  } else {
    api::Vehicle::setStop(id, stop.edge, stop.position, stop.lane, 0.0);  // cancels it
  }
  stops_.erase(found);
}

bool SumoHolds::is_hold(const std::string& id, const libsumo::TraCINextStopData& stop) const {
  const auto found = stops_.find(id);
  if (found == stops_.end()) return false;
  const Stop& held = found->second;
  return stop.duration > kForever / 2.0 && stop.endPos == held.position &&
         stop.lane == held.edge + '_' + std::to_string(held.lane);
}

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
