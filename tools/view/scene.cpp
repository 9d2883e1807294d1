#include "tools/view/scene.hpp"

#include <set>
#include <string>

namespace mvtp {

ReplayScene scene_of(const RoadNetwork& network) {
  ReplayScene scene;
  std::set<std::string> incoming;
  for (const auto& [id, junction] : network.junctions) {
    if (junction.shape.size() >= 3) scene.junctions.push_back(junction.shape);
    if (!junction.has_conflicts) continue;
    incoming.insert(junction.incoming_lanes.begin(), junction.incoming_lanes.end());
  }
  for (const auto& [id, lane] : network.lanes) {
    if (!lane.drivable || lane.shape.size() < 2) continue;
    scene.lanes.push_back({.shape = lane.shape,
                           .width = lane.width,
                           .internal = lane.internal,
                           .stop_line = incoming.contains(id)});
  }
  return scene;
}

ReplayScene scene_of(const Map& map) {
  return {.lanes = {},
          .junctions = {},
          .zones = {},
          .circles = map.circles,
          .polygons = map.polygons,
          .border = Point{map.width, map.height}};
}

}  // namespace mvtp
