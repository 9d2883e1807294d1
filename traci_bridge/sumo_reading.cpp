#include "traci_bridge/sumo_reading.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "traci_bridge/sumo_frame.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {
namespace {

constexpr int kParkedBits = 129;     // of getStopState(): stopped, in a parking area
constexpr int kParkingAreaBit = 64;  // of TraCINextStopData::stopFlags
const char* const kTurningRadius = "turning-radius";  // our parameter of a vType [m]

double turning_radius(const std::string& type, const std::string& text) {
  double radius = 0.0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, radius);
  if (error != std::errc() || rest != end || !std::isfinite(radius) || radius <= 0.0) {
    throw std::runtime_error("vType \"" + type + "\": the param " + kTurningRadius + " is \"" +
                             text + "\", not a number of metres above 0");
  }
  return radius;
}

}  // namespace

VehicleType read_type(const std::string& id) {
  VehicleType type{.id = id,
                   .body = body_of(api::VehicleType::getLength(id), api::VehicleType::getWidth(id)),
                   .min_gap = api::VehicleType::getMinGap(id),
                   .tau = api::VehicleType::getTau(id),
                   .vehicle_class = api::VehicleType::getVehicleClass(id)};
  type.body.max_speed = api::VehicleType::getMaxSpeed(id);
  type.body.max_accel = api::VehicleType::getAccel(id);
  type.body.max_decel = api::VehicleType::getDecel(id);
  if (const std::string radius = api::VehicleType::getParameter(id, kTurningRadius);
      !radius.empty()) {
    type.body.min_turning_radius = turning_radius(id, radius);
  }
  return type;
}

std::vector<Pedestrian> read_pedestrians() {
  std::vector<std::string> ids = api::Person::getIDList();
  std::ranges::sort(ids);
  std::vector<Pedestrian> pedestrians;
  for (const std::string& id : ids) {
    if (!api::Person::getVehicle(id).empty()) continue;  // rides
    const libsumo::TraCIPosition p = api::Person::getPosition(id);
    const double length = api::Person::getLength(id);
    // As of vehicles, SUMO's position is the middle of the front.
    const Pose middle = from_sumo({p.x, p.y, api::Person::getAngle(id)}, length / 2);
    pedestrians.push_back({.id = id,
                           .position = {middle.x, middle.y},
                           .theta = middle.theta,
                           .speed = api::Person::getSpeed(id),
                           .radius = std::hypot(length, api::Person::getWidth(id)) / 2,
                           .edge = api::Person::getRoadID(id),
                           .next = api::Person::getNextEdge(id)});
  }
  return pedestrians;
}

int count_collisions() {
  if (api::Simulation::getCollidingVehiclesNumber() == 0) return 0;
  std::set<std::pair<std::string, std::string>> pairs;  // SUMO reports most of them from each side
  for (const libsumo::TraCICollision& c : api::Simulation::getCollisions()) {
    pairs.insert(std::minmax(c.collider, c.victim));
  }
  return static_cast<int>(pairs.size());
}

std::optional<NextStop> next_parking_stop(const std::string& id) {
  const auto stops = api::Vehicle::getStops(id, 0);
  for (std::size_t i = 0; i < stops.size(); ++i) {
    if ((stops[i].stopFlags & kParkingAreaBit) != 0) return NextStop{int(i), stops[i]};
  }
  return std::nullopt;
}

bool is_parked(const std::string& id) {
  return (api::Vehicle::getStopState(id) & kParkedBits) == kParkedBits;
}

bool is_placed_beside_its_parking(const std::string& id) {
  const std::optional<NextStop> stop = next_parking_stop(id);
  return stop && stop->index == 0 && stop->data.lane == api::Vehicle::getLaneID(id) &&
         stop->data.endPos == api::Vehicle::getLanePosition(id) && !is_parked(id);
}

bool is_lane_free_beside(const std::string& id) {
  constexpr double kAhead = 5.0;    // [m]
  constexpr double kBehind = 40.0;  // [m]
  const std::optional<NextStop> stop = next_parking_stop(id);
  if (!stop) return true;
  const double end = stop->data.endPos;
  const double begin = end - api::Vehicle::getLength(id);
  const std::vector<std::string> others = api::Lane::getLastStepVehicleIDs(stop->data.lane);
  return std::ranges::none_of(others, [&](const std::string& other) {
    if (other == id) return false;
    const double front = api::Vehicle::getLanePosition(other);
    return front > begin - kBehind && front - api::Vehicle::getLength(other) < end + kAhead;
  });
}

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
