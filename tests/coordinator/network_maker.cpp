#include "tests/coordinator/network_maker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "coordinator/network/polyline.hpp"

namespace mvtp {
namespace {

Point unit(const Point& from, const Point& to) {
  const double length = std::hypot(to.x - from.x, to.y - from.y);
  return {(to.x - from.x) / length, (to.y - from.y) / length};
}

/// The line without its first `length` metres.
std::vector<Point> cut(std::vector<Point> line, double length) {
  while (line.size() > 2 && distance(line[0], line[1]) <= length) {
    length -= distance(line[0], line[1]);
    line.erase(line.begin());
  }
  const Point direction = unit(line[0], line[1]);
  line[0] = {line[0].x + length * direction.x, line[0].y + length * direction.y};
  return line;
}

std::vector<Point> without_ends(std::vector<Point> line, double first, double last) {
  line = cut(std::move(line), first);
  std::ranges::reverse(line);
  line = cut(std::move(line), last);
  std::ranges::reverse(line);
  return line;
}

/// The line moved to its right.
std::vector<Point> beside(const std::vector<Point>& line, double right) {
  std::vector<Point> moved;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Point direction = unit(line[i == 0 ? 0 : i - 1], line[std::min(i + 1, line.size() - 1)]);
    moved.push_back({line[i].x + right * direction.y, line[i].y - right * direction.x});
  }
  return moved;
}

/// From the end of one lane to the start of another: nearly an arc of a circle where there is one.
std::vector<Point> curve(const std::vector<Point>& from, const std::vector<Point>& to) {
  const Point a = from.back();
  const Point d = to.front();
  const Point begin = unit(from[from.size() - 2], a);
  const Point end = unit(d, to[1]);
  const double dot = std::clamp(begin.x * end.x + begin.y * end.y, -1.0, 1.0);
  const double angle = std::acos(dot);
  if (angle < 0.05) return {a, d};
  const double chord = distance(a, d);
  const double handle = 4.0 / 3.0 * std::tan(angle / 4.0) * chord / (2.0 * std::sin(angle / 2.0));
  const Point b{a.x + handle * begin.x, a.y + handle * begin.y};
  const Point c{d.x - handle * end.x, d.y - handle * end.y};
  std::vector<Point> points;
  for (int i = 0; i <= 10; ++i) {
    const double t = i / 10.0;
    const double u = 1.0 - t;
    const std::array<double, 4> w = {u * u * u, 3 * u * u * t, 3 * u * t * t, t * t * t};
    points.push_back({w[0] * a.x + w[1] * b.x + w[2] * c.x + w[3] * d.x,
                      w[0] * a.y + w[1] * b.y + w[2] * c.y + w[3] * d.y});
  }
  return points;
}

bool come_near(const std::vector<Point>& a, const std::vector<Point>& b) {
  constexpr double kBodies = 2.2;  // [m] wide, nearly
  const auto sampled = [](const std::vector<Point>& line) {
    std::vector<Point> points;
    for (std::size_t i = 1; i < line.size(); ++i) {
      for (int k = 0; k <= 20; ++k) {
        const double f = k / 20.0;
        points.push_back({line[i - 1].x + f * (line[i].x - line[i - 1].x),
                          line[i - 1].y + f * (line[i].y - line[i - 1].y)});
      }
    }
    return points;
  };
  const std::vector<Point> of_b = sampled(b);
  for (const Point& p : sampled(a)) {
    for (const Point& q : of_b) {
      if (std::hypot(p.x - q.x, p.y - q.y) < kBodies) return true;
    }
  }
  return false;
}

/// Their convex hull, counter-clockwise (Andrew 1979).
Polygon hull_of(std::vector<Point> points) {
  std::ranges::sort(
      points, [](const Point& a, const Point& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  const auto half = [&] {
    Polygon chain;
    for (const Point& p : points) {
      while (chain.size() >= 2) {
        const Point& a = chain[chain.size() - 2];
        const Point& b = chain.back();
        if ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) > 0.0) break;
        chain.pop_back();
      }
      chain.push_back(p);
    }
    chain.pop_back();
    return chain;
  };
  Polygon hull = half();
  std::ranges::reverse(points);
  const Polygon upper = half();
  hull.insert(hull.end(), upper.begin(), upper.end());
  return hull;
}

/// Does more than one path lead over the same ground?
bool has_conflicts(const Junction& junction, const RoadNetwork& network) {
  for (const Connection& a : junction.connections) {
    for (const Connection& b : junction.connections) {
      if (a.from_lane >= b.from_lane) continue;
      if (come_near(network.lanes.at(a.via[0]).shape, network.lanes.at(b.via[0]).shape))
        return true;
    }
  }
  return false;
}

}  // namespace

void NetworkMaker::node(const std::string& id, Point middle, double radius) {
  nodes_[id] = {.middle = middle, .radius = radius, .connections = {}};
}

void NetworkMaker::one_way(const std::string& a, const std::string& b, int lanes,
                           std::vector<Point> between) {
  between.insert(between.begin(), nodes_.at(a).middle);
  between.push_back(nodes_.at(b).middle);
  edges_[a + "-" + b] = {.from = a, .to = b, .lanes = lanes, .line = std::move(between)};
}

void NetworkMaker::road(const std::string& a, const std::string& b, int lanes) {
  one_way(a, b, lanes);
  one_way(b, a, lanes);
  edges_[a + "-" + b].two_directions = edges_[b + "-" + a].two_directions = true;
}

void NetworkMaker::connect(const std::string& from_lane, const std::string& to_lane) {
  const std::string to_edge = to_lane.substr(0, to_lane.rfind('_'));
  nodes_.at(edges_.at(to_edge).from).connections.emplace_back(from_lane, to_lane);
}

RoadNetwork NetworkMaker::make() const {
  RoadNetwork network;
  for (const auto& [id, edge] : edges_) add_lanes(id, edge, network);
  for (const auto& [id, node] : nodes_) add_junction(id, node, network);
  return network;
}

void NetworkMaker::add_lanes(const std::string& id, const Edge& edge, RoadNetwork& network) const {
  const std::vector<Point> line =
      without_ends(edge.line, nodes_.at(edge.from).radius, nodes_.at(edge.to).radius);
  for (int i = 0; i < edge.lanes; ++i) {
    const double from_middle = kLaneWidth * (edge.lanes - i - 0.5);
    const double right =
        edge.two_directions ? from_middle : from_middle - 0.5 * kLaneWidth * edge.lanes;
    Lane lane{.id = fmt::format("{}_{}", id, i), .edge = id, .index = i};
    lane.shape = beside(line, right);
    lane.length = length_of(lane.shape);
    network.edges[id].push_back(lane.id);
    network.lanes.emplace(lane.id, std::move(lane));
  }
}

std::vector<std::pair<std::string, std::string>> NetworkMaker::all_connections(
    const std::string& node, const RoadNetwork& network) const {
  std::vector<std::pair<std::string, std::string>> connections;
  for (const auto& [in, from] : edges_) {
    for (const auto& [out, to] : edges_) {
      if (from.to != node || to.from != node || to.to == from.from) continue;
      const std::vector<std::string>& ahead = network.edges.at(out);
      const std::vector<std::string>& lanes = network.edges.at(in);
      for (std::size_t i = 0; i < lanes.size(); ++i) {
        connections.emplace_back(lanes[i], ahead[std::min(i, ahead.size() - 1)]);
      }
    }
  }
  return connections;
}

void NetworkMaker::add_junction(const std::string& id, const Node& node,
                                RoadNetwork& network) const {
  Junction junction{.id = id, .type = "priority", .position = node.middle};
  std::vector<Point> border;
  const auto add_end = [&](const Lane& lane, const Point& end) {
    const Point direction = unit(lane.shape.front(), lane.shape.back());
    const double half = lane.width / 2.0;
    border.push_back({end.x + half * direction.y, end.y - half * direction.x});
    border.push_back({end.x - half * direction.y, end.y + half * direction.x});
  };
  for (const auto& [edge_id, edge] : edges_) {
    for (const std::string& lane : network.edges.at(edge_id)) {
      if (edge.to == id) junction.incoming_lanes.push_back(lane);
      if (edge.to == id) add_end(network.lanes.at(lane), network.lanes.at(lane).shape.back());
      if (edge.from == id) add_end(network.lanes.at(lane), network.lanes.at(lane).shape.front());
    }
  }
  const auto connections =
      node.connections.empty() ? all_connections(id, network) : node.connections;
  if (connections.empty()) junction.type = "dead_end";
  for (const auto& [from, to] : connections) {
    const std::string edge = fmt::format(":{}_{}", id, junction.connections.size());
    Lane via{.id = edge + "_0", .edge = edge, .internal = true};
    via.shape = curve(network.lanes.at(from).shape, network.lanes.at(to).shape);
    via.length = length_of(via.shape);
    if (via.shape.size() > 2) via.speed_limit = bend_limit_;
    junction.connections.push_back({from, {via.id}, to});
    network.lanes.emplace(via.id, std::move(via));
  }
  junction.shape = hull_of(std::move(border));
  junction.has_conflicts = has_conflicts(junction, network);
  network.junctions.emplace(id, std::move(junction));
}

RoadNetwork mirrored(RoadNetwork network) {
  network.left_hand = !network.left_hand;
  for (auto& [id, lane] : network.lanes) {
    for (Point& p : lane.shape) p.y = -p.y;
  }
  for (auto& [id, junction] : network.junctions) {
    junction.position.y = -junction.position.y;
    for (Point& p : junction.shape) p.y = -p.y;
    std::ranges::reverse(junction.shape);
  }
  return network;
}

}  // namespace mvtp
