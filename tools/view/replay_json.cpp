#include "tools/view/replay_json.hpp"

#include <cmath>

namespace mvtp {
namespace {

using Json = ReplayJson;

double centimetres(double metres) { return std::round(metres * 100.0) / 100.0; }

/// x, y, x, y, ... [m]
Json flat(const std::vector<Point>& points) {
  Json numbers = Json::array();
  for (const Point& point : points) {
    numbers.push_back(centimetres(point.x));
    numbers.push_back(centimetres(point.y));
  }
  return numbers;
}

Json flat(const std::vector<Polygon>& polygons) {
  Json all = Json::array();
  for (const Polygon& polygon : polygons) all.push_back(flat(polygon));
  return all;
}

Json to_json(const std::optional<Pose>& pose) {
  if (!pose) return nullptr;
  return {centimetres(pose->x), centimetres(pose->y), std::round(pose->theta * 1e4) / 1e4};
}

const char* name_of(ReplayEventKind kind) {
  switch (kind) {
    case ReplayEventKind::kOverlap:
      return "overlap";
    case ReplayEventKind::kPersonTouched:
      return "person touched";
    case ReplayEventKind::kOffRoad:
      return "off the road";
    case ReplayEventKind::kJump:
      return "jump";
    case ReplayEventKind::kAcceleration:
      return "acceleration exceeded";
    case ReplayEventKind::kHardBraking:
      return "hard braking";
    case ReplayEventKind::kNote:
      return "note";
  }
  return "";
}

}  // namespace

const char* name_of(ReplayLaneKind kind) {
  switch (kind) {
    case ReplayLaneKind::kCars:
      return "";
    case ReplayLaneKind::kBuses:
      return "bus";
    case ReplayLaneKind::kBicycles:
      return "bicycle";
    case ReplayLaneKind::kRail:
      return "rail";
    case ReplayLaneKind::kFoot:
      return "foot";
  }
  return "";
}

Json to_json(const ReplayScene& scene) {
  Json lanes = Json::array();
  for (const ReplayLane& lane : scene.lanes) {
    lanes.push_back({{"width", lane.width},
                     {"internal", lane.internal},
                     {"stop", lane.stop_line},
                     {"kind", name_of(lane.kind)},
                     {"shape", flat(lane.shape)}});
  }
  Json circles = Json::array();
  for (const Circle& circle : scene.circles) {
    circles.push_back({centimetres(circle.x), centimetres(circle.y), circle.radius});
  }
  Json crossings = Json::array();
  for (const ReplayCrossing& crossing : scene.crossings) {
    crossings.push_back({{"width", crossing.width}, {"shape", flat(crossing.shape)}});
  }
  Json lights = Json::array();
  for (const ReplayLight& light : scene.lights) {
    lights.push_back(
        {{"signal", light.signal},
         {"index", light.index},
         {"line", flat(std::vector<Point>{light.from, light.to})},
         {"target", light.target ? flat(std::vector<Point>{*light.target}) : nullptr}});
  }
  Json corridors = Json::array();
  for (const ReplayCorridor& corridor : scene.corridors) {
    corridors.push_back({{"zone", corridor.zone}, {"shape", flat(corridor.shape)}});
  }
  return {{"border", scene.border ? Json{scene.border->x, scene.border->y} : Json(nullptr)},
          {"lanes", std::move(lanes)},
          {"junctions", flat(scene.junctions)},
          {"zones", flat(scene.zones)},
          {"slots", flat(scene.slots)},
          {"crossings", std::move(crossings)},
          {"lights", std::move(lights)},
          {"corridors", std::move(corridors)},
          {"circles", std::move(circles)},
          {"polygons", flat(scene.polygons)}};
}

Json to_json(const ReplayTubes& tubes) {
  return {{"later", ReplayTube::kLater},
          {"units", ReplayTube::kUnits},
          {"every", ReplayTube::kEvery},
          {"paths", flat(tubes.paths())},
          {"forks", tubes.forks()}};
}

Json to_json(const ReplayVehicle& vehicle) {
  return {{"id", vehicle.id},
          {"kind", vehicle.kind},
          {"length", vehicle.length},
          {"width", vehicle.width},
          {"front", vehicle.front},
          {"maxSpeed", vehicle.max_speed},
          {"start", to_json(vehicle.start)},
          {"goal", to_json(vehicle.goal)},
          {"person", vehicle.person},
          {"automated", vehicle.automated},
          {"movement", vehicle.movement}};
}

Json to_json(const ReplayEvent& event, double end) {
  return {{"kind", name_of(event.kind)}, {"time", event.time}, {"end", end},
          {"x", event.place.x},          {"y", event.place.y}, {"vehicles", event.vehicles},
          {"value", event.value},        {"text", event.text}};
}

}  // namespace mvtp
