#include "tools/view/scene.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace mvtp {
namespace {

constexpr double kStopLineBack = 0.3;  // [m] from the end of the lane to its stop line

ReplayLaneKind kind_of(const Lane& lane) {
  if (lane.drivable) return ReplayLaneKind::kCars;
  if (lane.footpath) return ReplayLaneKind::kFoot;
  if (lane.road) return ReplayLaneKind::kBuses;
  if (lane.allows("bicycle")) return ReplayLaneKind::kBicycles;
  return lane.allows("tram") || lane.allows("rail") ? ReplayLaneKind::kRail : ReplayLaneKind::kFoot;
}

/// A piece of a line across the end of a course, `width` wide, between two fractions from its
/// right.
ReplayLight light_across(const std::vector<Point>& course, double width, double from, double to) {
  const Point& a = course[course.size() - 2];
  const Point& b = course.back();
  const double length = std::max(std::hypot(b.x - a.x, b.y - a.y), 1e-9);
  const Point along{(b.x - a.x) / length, (b.y - a.y) / length};
  const auto at = [&](double fraction) {
    const double left = (fraction - 0.5) * width;
    return Point{b.x - kStopLineBack * along.x - left * along.y,
                 b.y - kStopLineBack * along.y + left * along.x};
  };
  return {.from = at(from), .to = at(to)};
}

/// The stop lines of lanes, a piece for each connection that obeys a light.
void add_lane_lights(const RoadNetwork& network, const Junction& junction,
                     const std::map<std::string, std::size_t>& signals, ReplayScene& scene) {
  std::map<std::string, std::vector<const Connection*>> by_lane;
  for (const Connection& c : junction.connections) {
    if (signals.contains(c.signal)) by_lane[c.from_lane].push_back(&c);
  }
  for (auto& [id, connections] : by_lane) {
    const Lane& lane = network.lanes.at(id);
    std::ranges::sort(connections, {}, &Connection::signal_index);  // numbered from the right
    const double share = 1.0 / double(connections.size());
    for (std::size_t i = 0; i < connections.size(); ++i) {
      ReplayLight light =
          light_across(lane.shape, lane.width, double(i) * share, double(i + 1) * share);
      light.signal = signals.at(connections[i]->signal);
      light.index = connections[i]->signal_index;
      light.target = network.lanes.at(connections[i]->to_lane).shape.front();
      scene.lights.push_back(light);
    }
  }
}

/// Both ends of a crossing show its light.
void add_crossing(const PedestrianCrossing& crossing,
                  const std::map<std::string, std::size_t>& signals, ReplayScene& scene) {
  scene.crossings.push_back({crossing.shape, crossing.width});
  if (crossing.lights.empty() || !signals.contains(crossing.signal)) return;
  std::vector<Point> shape = crossing.shape;
  for (int end = 0; end < 2; ++end) {
    ReplayLight light = light_across(shape, crossing.width, 0.0, 1.0);
    light.signal = signals.at(crossing.signal);
    light.index = crossing.lights.front();
    scene.lights.push_back(light);
    std::ranges::reverse(shape);
  }
}

}  // namespace

ReplayScene scene_of(const RoadNetwork& network) {
  ReplayScene scene;
  std::map<std::string, std::size_t> signals;
  for (const auto& [id, lights] : network.signals) signals.emplace(id, signals.size());
  std::set<std::string> incoming;
  for (const auto& [id, junction] : network.junctions) {
    if (junction.shape.size() >= 3) scene.junctions.push_back(junction.shape);
    add_lane_lights(network, junction, signals, scene);
    for (const PedestrianCrossing& crossing : junction.crossings) {
      add_crossing(crossing, signals, scene);
    }
    if (!junction.has_conflicts) continue;
    incoming.insert(junction.incoming_lanes.begin(), junction.incoming_lanes.end());
  }
  for (const auto& [id, lane] : network.lanes) {
    if (lane.shape.size() < 2) continue;
    const ReplayLaneKind kind = kind_of(lane);
    scene.lanes.push_back({.shape = lane.shape,
                           .width = lane.width,
                           .internal = lane.internal,
                           .stop_line = kind != ReplayLaneKind::kFoot && incoming.contains(id),
                           .kind = kind});
  }
  return scene;
}

ReplayScene scene_of(const Map& map) {
  ReplayScene scene;
  scene.circles = map.circles;
  scene.polygons = map.polygons;
  scene.border = Point{map.width, map.height};
  return scene;
}

}  // namespace mvtp
