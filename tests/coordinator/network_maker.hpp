#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/network/road_network.hpp"

namespace mvtp {

/// Builds road networks out of nodes and roads between them; traffic keeps to the right.
///
/// The edge from node A to node B is "A-B", its lanes "A-B_0" (rightmost), "A-B_1", ...; lanes
/// inside node A are ":A_0_0", ... A connection is a curve between the ends of two lanes.
class NetworkMaker {
 public:
  static constexpr double kLaneWidth = 3.2;  ///< [m]

  /// @param radius  [m] from the middle to the lines where roads end.
  void node(const std::string& id, Point middle, double radius = 7.2);
  /// A one-way road from `a` to `b`, straight or through the points given between the nodes.
  void one_way(const std::string& a, const std::string& b, int lanes = 1,
               std::vector<Point> between = {});
  /// A road with lanes both ways.
  void road(const std::string& a, const std::string& b, int lanes = 1);
  /// A connection. A node where none is named connects every edge with every other but the one
  /// back.
  void connect(const std::string& from_lane, const std::string& to_lane);
  /// Bends are driven no faster than this [m/s].
  void limit_bends(double speed) { bend_limit_ = speed; }

  [[nodiscard]] RoadNetwork make() const;

 private:
  struct Node {
    Point middle;
    double radius = 0.0;
    std::vector<std::pair<std::string, std::string>> connections;  ///< lanes
  };
  struct Edge {
    std::string from, to;
    int lanes = 1;
    std::vector<Point> line;  ///< from node to node
    bool two_directions = false;
  };

  void add_lanes(const std::string& id, const Edge& edge, RoadNetwork& network) const;
  void add_junction(const std::string& id, const Node& node, RoadNetwork& network) const;
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> all_connections(
      const std::string& node, const RoadNetwork& network) const;

  std::map<std::string, Node> nodes_;
  std::map<std::string, Edge> edges_;
  double bend_limit_ = 6.5;
};

/// The same seen in a mirror: traffic keeps to the left.
[[nodiscard]] RoadNetwork mirrored(RoadNetwork network);

}  // namespace mvtp
