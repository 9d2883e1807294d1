#include "planner/problem/instance_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <unordered_map>
#include <utility>

#include "planner/problem/document.hpp"
#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "planner/problem/vehicle_file.hpp"
#include "planner/problem/yaml_text.hpp"

namespace mvtp {
namespace {

constexpr std::size_t kMaxBytes = 200'000'000;
constexpr std::size_t kMaxAgents = 1'000'000;
constexpr std::size_t kMaxObstacles = 10'000'000;
constexpr std::size_t kMaxPolygonPoints = 10'000;

Pose read_pose(const Value& value, YawSense sense) {
  value.require_list(3, 3, "[x, y, yaw]");
  const double yaw = value[2].number("rad");
  return {read_coordinate(value[0]), read_coordinate(value[1]),
          wrap_to_pi(sense == YawSense::kClockwise ? -yaw : yaw)};
}

// ---- agents

void reject_repeated_names(const std::string& file, const std::vector<Agent>& agents) {
  std::unordered_map<std::string_view, std::size_t> seen;
  for (std::size_t i = 0; i < agents.size(); ++i) {
    const auto [first, is_new] = seen.emplace(agents[i].name, i);
    if (is_new) continue;
    throw InputError(fmt::format("{}: agents[{}].name", file, i),
                     fmt::format("\"{}\" is the name of agents[{}] too; rename one", agents[i].name,
                                 first->second));
  }
}

std::string read_name(const Value& agent, std::size_t index) {
  const std::optional<Value> value = agent.find("name");
  if (!value) return fmt::format("agent{}", index);
  std::string name = value->text();
  if (name.empty() || name.size() > 200 || name.find_first_of("\n\r\t") != std::string::npos) {
    throw InputError(value->where(), fmt::format("is {}; give 1 to 200 characters in one line",
                                                 value->description()));
  }
  return name;
}

std::vector<Agent> read_agents(const Value& list, const VehiclePreset& fallback, YawSense sense) {
  list.require_list(1, kMaxAgents, "[{name: agent0, start: [x, y, yaw], goal: [x, y, yaw]}]");
  std::vector<Agent> agents;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Value entry = list[i];
    entry.require_map("{name: agent0, start: [x, y, yaw], goal: [x, y, yaw]}");
    entry.require_known_keys({"name", "start", "goal", "vehicle"});
    const std::optional<Value> vehicle = entry.find("vehicle");
    agents.push_back({read_name(entry, i),
                      vehicle ? read_vehicle(*vehicle, fallback).vehicle : fallback.vehicle,
                      read_pose(entry.at("start"), sense), read_pose(entry.at("goal"), sense)});
  }
  return agents;
}

// ---- map

std::vector<Circle> read_circles(const Value& list) {
  list.require_list(0, kMaxObstacles, "[[x, y, r], [x, y]]");
  std::vector<Circle> circles;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Value entry = list[i];
    entry.require_list(2, 3, "[x, y] or [x, y, r]");
    Circle circle{read_coordinate(entry[0]), read_coordinate(entry[1])};
    if (entry.size() == 3) circle.radius = read_length(entry[2]);
    circles.push_back(circle);
  }
  return circles;
}

double cross(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Do the open segments ab and cd cross in a single inner point?
bool segments_cross(const Point& a, const Point& b, const Point& c, const Point& d) {
  return cross(a, b, c) * cross(a, b, d) < 0.0 && cross(c, d, a) * cross(c, d, b) < 0.0;
}

void require_simple(const Value& value, const Polygon& polygon) {
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {
      if (!segments_cross(polygon[i], polygon[i + 1], polygon[j], polygon[(j + 1) % n])) continue;
      throw InputError(value.where(), fmt::format("its edges {} and {} cross; list the corners in "
                                                  "the order of the outline",
                                                  i, j));
    }
  }
}

Polygon read_polygon(const Value& value) {
  value.require_list(0, kMaxPolygonPoints, "[[x, y], [x, y], [x, y]]");
  Polygon polygon;
  for (std::size_t i = 0; i < value.size(); ++i) {
    value[i].require_list(2, 2, "[x, y]");
    const Point point{read_coordinate(value[i][0]), read_coordinate(value[i][1])};
    if (polygon.empty() || point != polygon.back()) polygon.push_back(point);
  }
  while (polygon.size() > 1 && polygon.front() == polygon.back()) polygon.pop_back();
  if (polygon.size() < 3) {
    throw InputError(value.where(),
                     fmt::format("has {} different points; give at least 3", polygon.size()));
  }
  double area = 0.0;
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    area += 0.5 * cross(polygon[0], polygon[i - 1], polygon[i]);
  }
  if (!(std::abs(area) > 1e-9)) {
    throw InputError(value.where(), fmt::format("has the area {:.3g} m2; give an outline that "
                                                "encloses something",
                                                std::abs(area)));
  }
  require_simple(value, polygon);
  return polygon;
}

Bounds read_bounds(const Value& value) {
  const std::string text = value.text();
  if (text == "axle") return Bounds::kAxle;
  if (text == "footprint") return Bounds::kFootprint;
  throw InputError(value.where(), fmt::format("is \"{}\"; choose axle or footprint", text));
}

Map read_map(const Value& value, bool is_plain_format) {
  value.require_map("{dimensions: [50, 50], obstacles: []}");
  value.require_known_keys({"dimensions", "obstacles", "polygons", "bounds"});
  Map map;
  const Value dimensions = value.at("dimensions");
  dimensions.require_list(2, 2, "[width, height]");
  map.width = read_length(dimensions[0]);
  map.height = read_length(dimensions[1]);
  // "obstacles:" with nothing behind it is how some generators write an empty map.
  const std::optional<Value> obstacles = value.find("obstacles");
  if (obstacles && obstacles->kind() != Value::Kind::kNull) map.circles = read_circles(*obstacles);
  if (const auto polygons = value.find("polygons")) {
    polygons->require_list(0, kMaxObstacles, "[[[x, y], [x, y], [x, y]]]");
    for (std::size_t i = 0; i < polygons->size(); ++i) {
      map.polygons.push_back(read_polygon((*polygons)[i]));
    }
    is_plain_format = false;
  }
  map.bounds = is_plain_format ? Bounds::kAxle : Bounds::kFootprint;
  if (const auto bounds = value.find("bounds")) map.bounds = read_bounds(*bounds);
  return map;
}

bool has_own_vehicles(const Value& agents) {
  for (std::size_t i = 0; i < agents.size(); ++i) {
    if (agents[i].find("vehicle")) return true;
  }
  return false;
}

// ---- the two formats

/// The CL-CBS / CSDO format with our extensions.
Instance read_extended(const Value& root, const VehiclePreset& fallback,
                       const InstanceReadOptions& options) {
  root.require_map("{agents: ..., map: ...}");
  root.require_known_keys({"agents", "map", "vehicle", "dt", "name", "description"});
  const std::optional<Value> vehicle = root.find("vehicle");
  VehiclePreset defaults = fallback;
  if (vehicle) {
    const VehiclePreset in_file = read_vehicle(*vehicle, fallback);
    if (!options.vehicle_preset) defaults = in_file;
  }
  Instance instance;
  instance.dt = defaults.dt;
  const std::optional<Value> dt = root.find("dt");
  if (dt) instance.dt = read_dt(*dt);

  const Value agents = root.at("agents");
  instance.agents = read_agents(agents, defaults, options.yaw);
  instance.map = read_map(root.at("map"), !vehicle && !dt && !has_own_vehicles(agents));
  return instance;
}

/// The JSON format of Guo and Yu's CarLikePlanning.
Instance read_guo_yu(const Value& root, const VehiclePreset& fallback, YawSense sense) {
  root.require_known_keys({"xmax", "ymax", "obstacles", "starts", "goals"});
  const Value starts = root.at("starts");
  const Value goals = root.at("goals");
  starts.require_list(1, kMaxAgents, "[[x, y, yaw]]");
  goals.require_list(1, kMaxAgents, "[[x, y, yaw]]");
  if (starts.size() != goals.size()) {
    throw InputError(goals.where(), fmt::format("has {} entries for {} starts; give one goal per "
                                                "start",
                                                goals.size(), starts.size()));
  }
  Instance instance;
  instance.dt = fallback.dt;
  instance.map.width = read_length(root.at("xmax"));
  instance.map.height = read_length(root.at("ymax"));
  instance.map.bounds = Bounds::kAxle;
  if (const auto obstacles = root.find("obstacles")) {
    instance.map.circles = read_circles(*obstacles);
  }
  for (std::size_t i = 0; i < starts.size(); ++i) {
    instance.agents.push_back({fmt::format("agent{}", i), fallback.vehicle,
                               read_pose(starts[i], sense), read_pose(goals[i], sense)});
  }
  return instance;
}

// ---- writing

std::string pose_text(const Pose& pose, YawSense sense) {
  const double yaw = sense == YawSense::kClockwise ? -pose.theta : pose.theta;
  return fmt::format("[{}, {}, {}]", yaml_number(pose.x), yaml_number(pose.y), yaml_number(yaw));
}

std::string map_text(const Map& map, bool is_plain_format) {
  std::string text = fmt::format("map:\n  dimensions: [{}, {}]\n", yaml_number(map.width),
                                 yaml_number(map.height));
  text += map.circles.empty() ? "  obstacles: []\n" : "  obstacles:\n";
  for (const Circle& circle : map.circles) {
    text += fmt::format("    - [{}, {}, {}]\n", yaml_number(circle.x), yaml_number(circle.y),
                        yaml_number(circle.radius));
  }
  if (!map.polygons.empty()) text += "  polygons:\n";
  for (const Polygon& polygon : map.polygons) {
    std::string points;
    for (const Point& point : polygon) {
      points += fmt::format("{}[{}, {}]", points.empty() ? "" : ", ", yaml_number(point.x),
                            yaml_number(point.y));
    }
    text += fmt::format("    - [{}]\n", points);
  }
  const Bounds implied =
      is_plain_format && map.polygons.empty() ? Bounds::kAxle : Bounds::kFootprint;
  if (map.bounds != implied) {
    text += fmt::format("  bounds: {}\n", map.bounds == Bounds::kAxle ? "axle" : "footprint");
  }
  return text;
}

}  // namespace

Instance read_instance(const std::string& path, const InstanceReadOptions& options) {
  // What is wrong with the options is said before what is wrong with the file.
  (void)read_preset("--vehicle", options.vehicle_preset.value_or("escot"));
  return parse_instance(path, read_text_file(path, kMaxBytes), options);
}

Instance parse_instance(const std::string& name, const std::string& text,
                        const InstanceReadOptions& options) {
  const VehiclePreset fallback = read_preset("--vehicle", options.vehicle_preset.value_or("escot"));
  const Document document = Document::parse(name, text, {"agents", "starts"}, "an instance file");
  const Value root = document.root();
  root.require_map("{agents: ..., map: ...}");
  Instance instance = root.find("starts") ? read_guo_yu(root, fallback, options.yaw)
                                          : read_extended(root, fallback, options);
  reject_repeated_names(name, instance.agents);
  if (options.bounds) instance.map.bounds = *options.bounds;
  if (options.dt) instance.dt = *options.dt;
  instance.initial_overlap = options.initial_overlap;
  return instance;
}

std::string instance_text(const Instance& instance, const InstanceWriteOptions& options) {
  const VehiclePreset standard = vehicle_preset("escot").value();
  const bool is_mixed = std::ranges::adjacent_find(instance.agents, std::ranges::not_equal_to{},
                                                   &Agent::vehicle) != instance.agents.end();
  const Vehicle common = instance.agents.empty() ? standard.vehicle : instance.agents[0].vehicle;
  const bool has_vehicle = !is_mixed && (common != standard.vehicle || options.name_vehicle);
  const double implied_dt = has_vehicle ? usual_dt(common) : standard.dt;
  const bool has_dt = instance.dt != implied_dt;

  std::string text;
  if (!options.description.empty()) {
    text += fmt::format("description: {}\n", yaml_string(options.description));
  }
  if (has_vehicle) text += fmt::format("vehicle: {}\n", vehicle_text(common));
  if (has_dt) text += fmt::format("dt: {}\n", yaml_number(instance.dt));
  text += "agents:\n";
  for (const Agent& agent : instance.agents) {
    const std::string own =
        is_mixed ? fmt::format(", vehicle: {}", vehicle_fields_text(agent.vehicle)) : "";
    text +=
        fmt::format("  - {{name: {}, start: {}, goal: {}{}}}\n", yaml_string(agent.name),
                    pose_text(agent.start, options.yaw), pose_text(agent.goal, options.yaw), own);
  }
  return text + map_text(instance.map, !has_vehicle && !has_dt && !is_mixed);
}

void write_instance(const Instance& instance, const std::string& path,
                    const InstanceWriteOptions& options) {
  write_text_file(path, instance_text(instance, options));
}

}  // namespace mvtp
