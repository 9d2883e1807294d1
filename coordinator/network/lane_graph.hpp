#pragma once

#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "coordinator/network/road_network.hpp"

namespace mvtp {

/// The lanes, edges and junctions of a road network by number, and what leads where.
class LaneGraph {
 public:
  static constexpr int kNone = -1;

  /// One connection: from a normal lane over the inside of a junction to the next normal lane.
  struct Link {
    int from = kNone;
    std::vector<int> via;  ///< internal lanes in driving order; may be empty
    int to = kNone;
    int junction = kNone;
    double length = 0.0;      ///< [m] of `via`
    std::string signal = {};  ///< as of Connection
    int signal_index = -1;
  };

  /// A crossing, and the junction that it belongs to.
  struct Crossing {
    const PedestrianCrossing* crossing = nullptr;
    int junction = kNone;
    double length = 0.0;  ///< [m] from kerb to kerb
  };

  /// @param network  must outlive the graph.
  explicit LaneGraph(const RoadNetwork& network);

  [[nodiscard]] const RoadNetwork& network() const { return network_; }
  [[nodiscard]] int lanes() const { return int(lanes_.size()); }
  [[nodiscard]] int edges() const { return int(lanes_of_.size()); }
  [[nodiscard]] int junctions() const { return int(junctions_.size()); }

  /// kNone if there is none with this id.
  [[nodiscard]] int find_lane(const std::string& id) const { return find(lane_numbers_, id); }
  [[nodiscard]] int find_edge(const std::string& id) const { return find(edge_numbers_, id); }
  [[nodiscard]] int find_junction(const std::string& id) const {
    return find(junction_numbers_, id);
  }

  [[nodiscard]] const Lane& lane(int l) const { return *lanes_[std::size_t(l)]; }
  [[nodiscard]] const Junction& junction(int j) const { return *junctions_[std::size_t(j)]; }
  /// The normal edge of a lane; of an internal lane: kNone.
  [[nodiscard]] int edge_of(int l) const { return edge_of_[std::size_t(l)]; }
  [[nodiscard]] std::span<const int> lanes_of(int edge) const {
    return lanes_of_[std::size_t(edge)];
  }
  [[nodiscard]] const std::string& edge_id(int edge) const {
    return lane(lanes_of(edge).front()).edge;
  }

  [[nodiscard]] const Link& link(int k) const { return links_[std::size_t(k)]; }
  [[nodiscard]] int links() const { return int(links_.size()); }
  /// Numbers of the links that leave, enter or run over a lane.
  [[nodiscard]] std::span<const int> links_from(int l) const { return from_[std::size_t(l)]; }
  [[nodiscard]] std::span<const int> links_to(int l) const { return to_[std::size_t(l)]; }
  [[nodiscard]] std::span<const int> links_over(int l) const { return over_[std::size_t(l)]; }
  /// Is this lane inside one of these junctions? Also if nobody knows which it is inside.
  [[nodiscard]] bool is_inside(int lane, const std::vector<bool>& junctions) const {
    const std::span<const int> over = links_over(lane);
    return edge_of(lane) == kNone &&
           (over.empty() || junctions[std::size_t(link(over.front()).junction)]);
  }
  /// Those that lead from lane `l` to this edge.
  [[nodiscard]] std::vector<int> links_between(int l, int edge) const;
  [[nodiscard]] const Crossing& crossing(int c) const { return crossings_[std::size_t(c)]; }
  [[nodiscard]] int crossings() const { return int(crossings_.size()); }
  /// The junction at the end of an edge; kNone if nothing leaves it.
  [[nodiscard]] int junction_behind(int edge) const { return behind_[std::size_t(edge)]; }

 private:
  using Numbers = std::unordered_map<std::string, int>;

  [[nodiscard]] static int find(const Numbers& numbers, const std::string& id) {
    const auto found = numbers.find(id);
    return found == numbers.end() ? kNone : found->second;
  }
  void add_link(const Connection& connection, int junction);
  void add_crossing(const PedestrianCrossing& crossing, int junction);

  const RoadNetwork& network_;
  Numbers lane_numbers_, edge_numbers_, junction_numbers_;
  std::vector<const Lane*> lanes_;
  std::vector<const Junction*> junctions_;
  std::vector<int> edge_of_;
  std::vector<std::vector<int>> lanes_of_;
  std::vector<Link> links_;
  std::vector<Crossing> crossings_;
  std::vector<std::vector<int>> from_, to_, over_;
  std::vector<int> behind_;
};

}  // namespace mvtp
