#include "traci_bridge/sumo_vehicles.hpp"

#include <limits>
#include <optional>
#include <utility>

#include "traci_bridge/sumo_frame.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {
namespace {

constexpr double kStanding = 0.1;  // [m/s]

}  // namespace

void SumoVehicles::read(std::string id, VehicleState& state) {
  Constant& vehicle = known(id);
  const libsumo::TraCIPosition p = api::Vehicle::getPosition(id);
  const std::optional<double> told = controlled_.speed(id);
  state.type = vehicle.type;
  state.pose = from_sumo({p.x, p.y, api::Vehicle::getAngle(id)}, vehicle.front);
  state.speed = told ? *told : api::Vehicle::getSpeed(id);
  state.speed_factor = vehicle.speed_factor;
  state.lane = api::Vehicle::getLaneID(id);
  if (!told && state.lane != vehicle.lane) look_up_top_speed(id, state.lane, vehicle);
  state.top_speed = vehicle.top_speed;
  state.lane_position = state.lane.empty() ? 0.0 : api::Vehicle::getLanePosition(id);
  state.halted_by_stop =
      state.speed < kStanding && !told && !holds_.contains(id) && SumoHolds::is_at_stop(id);
  state.id = std::move(id);
}

SumoVehicles::Constant& SumoVehicles::known(const std::string& id) {
  const auto found = known_.find(id);
  if (found != known_.end()) return found->second;
  const double length = api::Vehicle::getLength(id);
  return known_[id] = {.type = api::Vehicle::getTypeID(id),
                       .front = body_of(length, api::Vehicle::getWidth(id)).front,
                       .speed_factor = api::Vehicle::getSpeedFactor(id)};
}

/// It shows on lanes that allow more: SUMO tells only how fast the vehicle may be where it is. Who
/// is faster later on was held back by a limit of that lane for its kind.
void SumoVehicles::look_up_top_speed(const std::string& id, const std::string& lane,
                                     Constant& vehicle) {
  constexpr double kRounding = 1e-3;  // [m/s]
  vehicle.lane = lane;
  if (lane.empty()) return;
  const double limit = api::Lane::getMaxSpeed(lane) * vehicle.speed_factor;
  const double allowed = api::Vehicle::getAllowedSpeed(id);
  if (allowed < limit - kRounding) {
    vehicle.top_speed = allowed;
  } else if (limit > vehicle.top_speed) {
    vehicle.top_speed = std::numeric_limits<double>::infinity();
  }
}

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
