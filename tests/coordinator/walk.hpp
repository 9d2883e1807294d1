#pragma once

#include <string>
#include <vector>

#include "coordinator/corridor/corridor_course.hpp"
#include "coordinator/network/partition.hpp"

namespace mvtp {

/// A network to walk on, with every conflicting junction coordinated.
struct Walk {
  explicit Walk(RoadNetwork n, const CorridorOptions& options = {})
      : network(std::move(n)),
        graph(network),
        finder(graph, select_junctions(graph, {}, options.chain), options) {}

  [[nodiscard]] CourseQuery at(const std::string& lane, double position,
                               std::vector<std::string> edges) {
    route.clear();
    for (const std::string& edge : edges) route.push_back(graph.find_edge(edge));
    return {.lane = graph.find_lane(lane), .position = position, .edges = route};
  }

  [[nodiscard]] std::vector<std::string> lanes(const CorridorCourse& course) const {
    std::vector<std::string> ids;
    for (const CorridorPiece& piece : course.pieces) ids.push_back(graph.lane(piece.lane).id);
    return ids;
  }

  RoadNetwork network;
  LaneGraph graph;
  CourseFinder finder;
  std::vector<int> route;
};

}  // namespace mvtp
