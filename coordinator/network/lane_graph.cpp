#include "coordinator/network/lane_graph.hpp"

#include <cmath>

namespace mvtp {

LaneGraph::LaneGraph(const RoadNetwork& network) : network_(network) {
  for (const auto& [id, lane] : network.lanes) {
    lane_numbers_.emplace(id, int(lanes_.size()));
    lanes_.push_back(&lane);
  }
  edge_of_.assign(lanes_.size(), kNone);
  for (const auto& [id, lanes] : network.edges) {
    const int edge = int(lanes_of_.size());
    edge_numbers_.emplace(id, edge);
    std::vector<int>& numbers = lanes_of_.emplace_back();
    for (const std::string& lane : lanes) {
      numbers.push_back(lane_numbers_.at(lane));
      edge_of_[std::size_t(numbers.back())] = edge;
    }
  }
  from_.resize(lanes_.size());
  to_.resize(lanes_.size());
  over_.resize(lanes_.size());
  behind_.assign(lanes_of_.size(), kNone);
  for (const auto& [id, junction] : network.junctions) {
    const int number = int(junctions_.size());
    junction_numbers_.emplace(id, number);
    junctions_.push_back(&junction);
    for (const Connection& c : junction.connections) add_link(c, number);
    for (const PedestrianCrossing& c : junction.crossings) add_crossing(c, number);
  }
}

void LaneGraph::add_link(const Connection& c, int junction) {
  const int number = int(links_.size());
  Link link{.from = lane_numbers_.at(c.from_lane),
            .via = {},
            .to = lane_numbers_.at(c.to_lane),
            .junction = junction,
            .signal = c.signal,
            .signal_index = c.signal_index};
  for (const std::string& via : c.via) {
    link.via.push_back(lane_numbers_.at(via));
    link.length += lane(link.via.back()).length;
    over_[std::size_t(link.via.back())].push_back(number);
  }
  from_[std::size_t(link.from)].push_back(number);
  to_[std::size_t(link.to)].push_back(number);
  behind_[std::size_t(edge_of(link.from))] = junction;
  links_.push_back(std::move(link));
}

std::vector<int> LaneGraph::links_between(int l, int edge) const {
  std::vector<int> links;
  for (const int k : links_from(l)) {
    if (edge_of(link(k).to) == edge) links.push_back(k);
  }
  return links;
}

void LaneGraph::add_crossing(const PedestrianCrossing& crossing, int junction) {
  Crossing& added = crossings_.emplace_back(Crossing{&crossing, junction, 0.0});
  for (std::size_t i = 1; i < crossing.shape.size(); ++i) {
    const Point& a = crossing.shape[i - 1];
    const Point& b = crossing.shape[i];
    added.length += std::hypot(b.x - a.x, b.y - a.y);
  }
}

}  // namespace mvtp
