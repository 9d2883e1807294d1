#include "traci_bridge/sumo_controlled.hpp"

#include <algorithm>

namespace mvtp::MVTP_SUMO_NAMESPACE {
namespace {

// moveToXY's bits "keep the route" and "off the road is allowed": poses are exact and the route
// stays. Every other value snaps to lanes, or rewrites the route.
constexpr int kKeepRoute = 3;
constexpr int kNewRoute = 2;          // the same, but the route is that of the lane it comes to
constexpr int kOntoRoute = 1;         // onto the nearest lane of the route, and its middle
constexpr double kAnyDistance = 1e6;  // [m]

}  // namespace

std::optional<double> SumoControlled::speed(const std::string& id) const {
  const auto found = vehicles_.find(id);
  return found == vehicles_.end() ? std::nullopt : std::optional(found->second.speed);
}

void SumoControlled::take_over(const std::string& id, double front) {
  unrestored_.erase(id);
  const libsumo::TraCIPosition p = api::Vehicle::getPosition(id);
  vehicles_[id] = {.front = front,
                   .position = {p.x, p.y, api::Vehicle::getAngle(id)},
                   .speed = api::Vehicle::getSpeed(id),
                   .speed_mode = SumoDrivers::own_speed_mode(id),
                   .lane_change_mode = drivers_.take_lane_change_mode(id)};
  api::Vehicle::setSpeedMode(id, kObey);
  api::Vehicle::setLaneChangeMode(id, kObey);
}

void SumoControlled::hand_back(const std::string& id) {
  const Controlled& vehicle = vehicles_.at(id);
  settle(id, 0.0);
  widths_.restore(id);
  if (!routes_.restore(id, clock_.now)) unrestored_.insert(id);
  if (api::Vehicle::getLaneID(id).empty()) put_onto_route(id, vehicle);
  // SUMO only knows a speed it has measured itself, cut off at the limit of the lane.
  api::Vehicle::setPreviousSpeed(id, vehicle.speed);
  api::Vehicle::setSpeedMode(id, vehicle.speed_mode);
  drivers_.change_lanes_again(id, vehicle.lane_change_mode, clock_.now);
  vehicles_.erase(id);
}

void SumoControlled::place(const std::string& id, const Pose& pose, double speed) {
  Controlled& vehicle = vehicles_.at(id);
  vehicle.position = to_sumo(pose, vehicle.front);
  vehicle.speed = speed;
}

void SumoControlled::drive_along(const std::string& id, std::span<const std::string> edges) {
  const std::size_t length = routes_.length_to_cut(id, edges, clock_.now);
  if (length > 0) cut_route(id, length);
}

void SumoControlled::leave_road(const std::string& id) {
  Controlled& vehicle = vehicles_.at(id);
  if (!vehicle.rest_of_route.empty()) return;
  const std::span<const std::string> rest = routes_.rest(id, clock_.now);
  vehicle.rest_of_route.assign(rest.begin(), rest.end());
  (void)routes_.restore(id, clock_.now);
  api::Vehicle::setRoute(id, std::vector<std::string>{vehicle.rest_of_route.front()});
}

void SumoControlled::enter_road(const std::string& id, const std::string& lane) {
  Controlled& vehicle = vehicles_.at(id);
  const std::string& edge = network_.lanes.at(lane).edge;
  std::vector<std::string>& rest = vehicle.rest_of_route;
  const auto here = std::ranges::find(rest, edge);
  if (here == rest.end()) return;
  rest.erase(rest.begin(), here);
  vehicle.lane_index = network_.lanes.at(lane).index;
  vehicle.enters = true;
}

void SumoControlled::send(const std::set<std::string>& waiting) {
  std::erase_if(unrestored_,
                [&](const std::string& id) { return routes_.restore(id, clock_.now); });
  for (const auto& [id, vehicle] : vehicles_) {
    if (waiting.contains(id)) continue;
    const Lane* lane = settle(id, vehicle.speed);
    if (const std::size_t next = routes_.next_cut(id, clock_.now)) {
      routes_.cut(id, next, clock_.now);
    }
    const SumoPosition& p = vehicle.position;
    if (lane != nullptr && vehicle.rest_of_route.empty()) widths_.widen(id, *lane, p);
    api::Vehicle::moveToXY(id, vehicle.enters ? vehicle.rest_of_route.front() : "",
                           vehicle.enters ? vehicle.lane_index : -1, p.x_m, p.y_m, p.angle_deg,
                           vehicle.enters ? kNewRoute : kKeepRoute, kAnyDistance);
  }
}

void SumoControlled::resume_routes() {
  for (auto& [id, vehicle] : vehicles_) {
    if (!vehicle.enters || api::Vehicle::getRoadID(id) != vehicle.rest_of_route.front()) continue;
    api::Vehicle::setRoute(id, vehicle.rest_of_route);
    vehicle.rest_of_route.clear();
    vehicle.enters = false;
  }
}

void SumoControlled::forget_if(const std::function<bool(const std::string&)>& has_left) {
  std::erase_if(vehicles_, [&](const auto& entry) {
    if (!has_left(entry.first)) return false;
    routes_.forget(entry.first);
    return true;
  });
  std::erase_if(unrestored_, has_left);
  widths_.forget_if(has_left);
}

const Lane* SumoControlled::settle(const std::string& id, double speed) {
  return lanes_.settle(id, routes_.rest(id, clock_.now), speed, clock_.step_length);
}

void SumoControlled::cut_route(const std::string& id, std::size_t length) {
  settle(id, 0.0);
  routes_.cut(id, length, clock_.now);
}

/// From open ground onto the road, in the next step: SUMO's driver cannot go back.
void SumoControlled::put_onto_route(const std::string& id, const Controlled& vehicle) {
  const SumoPosition& p = vehicle.position;
  api::Vehicle::moveToXY(id, "", -1, p.x_m, p.y_m, p.angle_deg, kOntoRoute, kAnyDistance);
}

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
