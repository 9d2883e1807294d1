#include "tools/view/read_replay.hpp"

#include <functional>
#include <nlohmann/json.hpp>

#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

using Json = nlohmann::json;

/// x, y, x, y, ...
std::vector<Point> points_of(const Json& numbers) {
  std::vector<Point> points;
  for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) {
    points.push_back({numbers.at(i).get<double>(), numbers.at(i + 1).get<double>()});
  }
  return points;
}

ReplayVehicle vehicle_of(const Json& json) {
  return {.id = json.at("id").get<std::string>(),
          .kind = json.at("kind").get<std::string>(),
          .length = json.at("length").get<double>(),
          .width = json.at("width").get<double>(),
          .front = json.at("front").get<double>(),
          .max_speed = json.at("maxSpeed").get<double>()};
}

ReplayScene scene_of(const Json& json) {
  ReplayScene scene;
  for (const Json& lane : json.at("lanes")) {
    scene.lanes.push_back({.shape = points_of(lane.at("shape")),
                           .width = lane.at("width").get<double>(),
                           .internal = lane.at("internal").get<bool>(),
                           .stop_line = lane.at("stop").get<bool>()});
  }
  for (const Json& polygon : json.at("polygons")) scene.polygons.push_back(points_of(polygon));
  for (const Json& circle : json.at("circles")) {
    scene.circles.push_back(
        {circle.at(0).get<double>(), circle.at(1).get<double>(), circle.at(2).get<double>()});
  }
  return scene;
}

template <class Value>
Value read(const Replay& replay, const std::string& where,
           const std::function<Value(const Json&)>& value_of) {
  try {
    return value_of(Json::parse(replay.header));
  } catch (const Json::exception&) {
    throw InputError(where, "the replay in it is damaged; write the page again");
  }
}

}  // namespace

std::vector<ReplayVehicle> vehicles_of(const Replay& replay, const std::string& where) {
  return read<std::vector<ReplayVehicle>>(replay, where, [](const Json& header) {
    std::vector<ReplayVehicle> vehicles;
    for (const Json& vehicle : header.at("vehicles")) vehicles.push_back(vehicle_of(vehicle));
    return vehicles;
  });
}

ReplayScene scene_of(const Replay& replay, const std::string& where) {
  return read<ReplayScene>(replay, where,
                           [](const Json& header) { return scene_of(header.at("scene")); });
}

}  // namespace mvtp
