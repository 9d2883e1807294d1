#include "coordinator/network/partition.hpp"

#include <algorithm>
#include <numeric>

#include "planner/problem/input_error.hpp"

namespace mvtp {

namespace {

/// The junctions that a link of `junction` leads to within `chain` metres, over the junctions
/// without conflicts between them.
template <class Visitor>
void for_each_near(const LaneGraph& graph, int from_lane, double left, const Visitor& visitor) {
  const double length = graph.lane(from_lane).length;
  const int behind = graph.junction_behind(graph.edge_of(from_lane));
  if (length >= left || behind == LaneGraph::kNone) return;
  if (graph.junction(behind).has_conflicts) return visitor(behind);
  for (const int k : graph.links_from(from_lane)) {
    for_each_near(graph, graph.link(k).to, left - length - std::max(0.1, graph.link(k).length),
                  visitor);
  }
}

}  // namespace

std::vector<bool> select_junctions(const LaneGraph& graph, std::span<const std::string> ids,
                                   double chain) {
  std::vector<bool> chosen(std::size_t(graph.junctions()), false);
  for (const std::string& id : ids) {
    const int junction = graph.find_junction(id);
    if (junction == LaneGraph::kNone) {
      throw InputError("--junction " + id, "the network has no junction with this id");
    }
    chosen[std::size_t(junction)] = true;
  }
  if (ids.empty()) {
    for (int j = 0; j < graph.junctions(); ++j) {
      chosen[std::size_t(j)] = graph.junction(j).has_conflicts;
    }
  }
  for (bool grown = true; grown;) {
    grown = false;
    for (int k = 0; k < graph.links(); ++k) {
      const LaneGraph::Link& link = graph.link(k);
      for_each_near(graph, link.to, chain, [&](int near) {
        const bool a = chosen[std::size_t(near)];
        const bool b = chosen[std::size_t(link.junction)];
        if (a == b || !graph.junction(link.junction).has_conflicts) return;
        chosen[std::size_t(near)] = chosen[std::size_t(link.junction)] = true;
        grown = true;
      });
    }
  }
  return chosen;
}

std::vector<ControlZone> partition(const LaneGraph& graph, const std::vector<bool>& coordinated,
                                   double chain) {
  std::vector<int> root(std::size_t(graph.junctions()));
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int j) {
    while (root[std::size_t(j)] != j)
      j = root[std::size_t(j)] = root[std::size_t(root[std::size_t(j)])];
    return j;
  };
  for (int k = 0; k < graph.links(); ++k) {
    const LaneGraph::Link& link = graph.link(k);
    if (!coordinated[std::size_t(link.junction)]) continue;
    for_each_near(graph, link.to, chain, [&](int near) {
      if (coordinated[std::size_t(near)]) {
        const int a = find(near);
        const int b = find(link.junction);
        root[std::size_t(std::max(a, b))] = std::min(a, b);
      }
    });
  }
  std::vector<int> zone_of(root.size(), LaneGraph::kNone);
  std::vector<ControlZone> zones;
  for (int j = 0; j < graph.junctions(); ++j) {
    if (!coordinated[std::size_t(j)]) continue;
    int& zone = zone_of[std::size_t(find(j))];
    if (zone == LaneGraph::kNone) {
      zone = int(zones.size());
      zones.emplace_back();
    }
    zones[std::size_t(zone)].junctions.push_back(j);
    zones[std::size_t(zone)].connections += int(graph.junction(j).connections.size());
  }
  return zones;
}

}  // namespace mvtp
