#include "traci_bridge/sumo_vehicles.hpp"

#include <optional>
#include <utility>

#include "traci_bridge/sumo_frame.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {
namespace {

constexpr double kStanding = 0.1;  // [m/s]

}  // namespace

void SumoVehicles::read(std::string id, VehicleState& state) {
  const Constant& vehicle = known(id);
  const libsumo::TraCIPosition p = api::Vehicle::getPosition(id);
  const std::optional<double> told = controlled_.speed(id);
  state.type = vehicle.type;
  state.pose = from_sumo({p.x, p.y, api::Vehicle::getAngle(id)}, vehicle.front);
  state.speed = told ? *told : api::Vehicle::getSpeed(id);
  state.speed_factor = vehicle.speed_factor;
  state.lane = api::Vehicle::getLaneID(id);
  state.lane_position = state.lane.empty() ? 0.0 : api::Vehicle::getLanePosition(id);
  state.halted_by_stop =
      state.speed < kStanding && !told && !holds_.contains(id) && SumoHolds::is_at_stop(id);
  state.id = std::move(id);
}

const SumoVehicles::Constant& SumoVehicles::known(const std::string& id) {
  const auto found = known_.find(id);
  if (found != known_.end()) return found->second;
  const double length = api::Vehicle::getLength(id);
  return known_[id] = {.type = api::Vehicle::getTypeID(id),
                       .front = body_of(length, api::Vehicle::getWidth(id)).front,
                       .speed_factor = api::Vehicle::getSpeedFactor(id)};
}

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
