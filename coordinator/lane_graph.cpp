#include "coordinator/lane_graph.hpp"

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

}  // namespace mvtp
