#include "coordinator/free_flow.hpp"

#include <algorithm>

namespace mvtp {
namespace {

/// The connection from one edge to another, from `lane` if there is one; nullptr if there is none.
const Connection* connection_between(const RoadNetwork& network, const std::string& lane,
                                     const std::string& from_edge, const std::string& to_edge) {
  const Connection* any = nullptr;
  for (const auto& [id, junction] : network.junctions) {
    for (const Connection& c : junction.connections) {
      if (network.lanes.at(c.from_lane).edge != from_edge) continue;
      if (network.lanes.at(c.to_lane).edge != to_edge) continue;
      if (c.from_lane == lane) return &c;
      if (!any) any = &c;
    }
  }
  return any;
}

}  // namespace

double free_flow_duration(const RoadNetwork& network, std::span<const std::string> route,
                          const std::string& first_lane, double from, double to,
                          double speed_factor, double max_speed) {
  const auto time_on = [&](const std::string& id, double length) {
    const Lane& lane = network.lanes.at(id);
    return length / std::min(lane.speed_limit * speed_factor, max_speed);
  };
  double duration = 0.0;
  std::string lane = first_lane;
  double begin = from;
  for (std::size_t i = 0; i + 1 < route.size(); ++i) {
    const Connection* c = connection_between(network, lane, route[i], route[i + 1]);
    duration += time_on(lane, network.lanes.at(lane).length - begin);
    begin = 0.0;
    if (!c) {
      lane = network.edges.at(route[i + 1]).front();
      continue;
    }
    for (const std::string& via : c->via) duration += time_on(via, network.lanes.at(via).length);
    lane = c->to_lane;
  }
  return duration + time_on(lane, std::max(0.0, to - begin));
}

}  // namespace mvtp
