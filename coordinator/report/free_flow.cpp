#include "coordinator/report/free_flow.hpp"

#include <algorithm>

namespace mvtp {

FreeFlow::FreeFlow(const RoadNetwork& network) : network_(network) {
  for (const auto& [id, junction] : network.junctions) {
    for (const Connection& c : junction.connections) {
      connections_[{network.lanes.at(c.from_lane).edge, network.lanes.at(c.to_lane).edge}]
          .push_back(&c);
    }
  }
}

/// From `lane` if there is one, else any; nullptr if there is none.
const Connection* FreeFlow::connection(const std::string& lane, const std::string& from_edge,
                                       const std::string& to_edge) const {
  const auto found = connections_.find({from_edge, to_edge});
  if (found == connections_.end()) return nullptr;
  const auto own = std::ranges::find(found->second, lane, &Connection::from_lane);
  return own == found->second.end() ? found->second.front() : *own;
}

double FreeFlow::duration(std::span<const std::string> route, const std::string& first_lane,
                          double from, double to, double speed_factor, double max_speed) const {
  const auto time_on = [&](const std::string& id, double length) {
    return length / std::min(network_.lanes.at(id).speed_limit * speed_factor, max_speed);
  };
  double duration = 0.0;
  std::string lane = first_lane;
  double begin = from;
  for (std::size_t i = 0; i + 1 < route.size(); ++i) {
    const Connection* c = connection(lane, route[i], route[i + 1]);
    duration += time_on(lane, network_.lanes.at(lane).length - begin);
    begin = 0.0;
    if (!c) {
      lane = network_.edges.at(route[i + 1]).front();
      continue;
    }
    for (const std::string& via : c->via) duration += time_on(via, network_.lanes.at(via).length);
    lane = c->to_lane;
  }
  return duration + time_on(lane, std::max(0.0, to - begin));
}

}  // namespace mvtp
