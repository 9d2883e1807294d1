#include "tests/coordinator/shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "coordinator/network/polyline.hpp"

namespace mvtp {
namespace {

constexpr double kPi = std::numbers::pi;

constexpr double kHalf = 7.2;   // [m] from the centre to the stop lines
constexpr double kAside = 1.6;  // [m] from the middle of the road to the lanes' centre lines
const std::array<std::string, 4> kArms = {"W", "S", "E", "N"};

Point turned(Point p, int quarters) {
  for (int i = 0; i < quarters; ++i) p = {-p.y, p.x};
  return p;
}

Lane make_lane(const std::string& edge, std::vector<Point> shape, int quarters, bool internal) {
  Lane lane{.id = edge + "_0", .edge = edge, .internal = internal};
  for (Point& p : shape) p = turned(p, quarters);
  lane.length = length_of(shape);
  lane.shape = std::move(shape);
  if (internal && lane.shape.size() > 2) lane.speed_limit = 6.5;
  return lane;
}

std::vector<Point> arc(Point centre, double radius, double from, double to) {
  std::vector<Point> points;
  for (int i = 0; i <= 8; ++i) {
    const double a = from + (to - from) * i / 8.0;
    points.push_back({centre.x + radius * std::cos(a), centre.y + radius * std::sin(a)});
  }
  return points;
}

/// A node with an arm to each end; the ends are where vehicles come and go.
void add_arms(NetworkMaker& maker, const std::string& middle, const std::vector<std::string>& ends,
              int lanes, NetworkShape& shape) {
  for (const std::string& end : ends) {
    maker.road(middle, end, lanes);
    shape.sources.push_back(end + "-" + middle);
    shape.sinks.push_back(middle + "-" + end);
  }
}

}  // namespace

RoadNetwork make_crossroads(double arm) {
  RoadNetwork network;
  Junction centre{.id = "C", .type = "priority", .has_conflicts = true};
  centre.shape = {{-kHalf, -3.2}, {-3.2, -kHalf}, {3.2, -kHalf}, {kHalf, -3.2},
                  {kHalf, 3.2},   {3.2, kHalf},   {-3.2, kHalf}, {-kHalf, 3.2}};
  const std::vector<Point> in = {{-arm, -kAside}, {-kHalf, -kAside}};
  const std::vector<Point> out = {{-kHalf, kAside}, {-arm, kAside}};
  const std::array<std::vector<Point>, 3> turns = {
      arc({-kHalf, -kHalf}, kHalf - kAside, kPi / 2, 0.0),
      {{-kHalf, -kAside}, {kHalf, -kAside}},
      arc({-kHalf, kHalf}, kHalf + kAside, -kPi / 2, 0.0)};
  const auto add = [&](Lane lane) {
    if (!lane.internal) network.edges[lane.edge] = {lane.id};
    network.lanes.emplace(lane.id, std::move(lane));
  };
  for (int k = 0; k < 4; ++k) {
    const std::string& from = kArms[std::size_t(k)];
    add(make_lane(from + "_in", in, k, false));
    add(make_lane(from + "_out", out, k, false));
    centre.incoming_lanes.push_back(from + "_in_0");
    for (int w = 0; w < 3; ++w) {
      const std::string& to = kArms[std::size_t((k + w + 1) % 4)];
      add(make_lane(":C_" + from + to, turns[std::size_t(w)], k, true));
      centre.connections.push_back({from + "_in_0", {":C_" + from + to + "_0"}, to + "_out_0"});
    }
  }
  network.junctions.emplace("C", std::move(centre));
  return network;
}

void add_crossroads(NetworkMaker& maker, NetworkShape& shape, double arm, double radius) {
  maker.node("C", {0, 0}, radius);
  for (int k = 0; k < 4; ++k) {
    const Point end = turned({-arm, 0.0}, k);
    maker.node(kArms[std::size_t(k)], end, 0.0);
  }
  add_arms(maker, "C", {"W", "S", "E", "N"}, 1, shape);
}

NetworkShape crossroads_shape(double arm, double radius) {
  NetworkShape shape{.name = "crossroads"};
  NetworkMaker maker;
  add_crossroads(maker, shape, arm, radius);
  shape.network = maker.make();
  return shape;
}

NetworkShape grid_shape() {
  NetworkShape shape{.name = "grid"};
  NetworkMaker maker;
  const std::array<double, 3> x = {0.0, 36.0, 95.0};
  const std::array<double, 3> y = {0.0, 42.0, 86.0};
  const auto name = [](int i, int j) { return fmt::format("{}{}", char('A' + i), j); };
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) maker.node(name(i, j), {x[std::size_t(i)], y[std::size_t(j)]});
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (i < 2) maker.road(name(i, j), name(i + 1, j));
      if (j < 2) maker.road(name(i, j), name(i, j + 1));
    }
  }
  constexpr double kArm = 90.0;
  for (std::size_t k = 0; k < 3; ++k) {
    maker.node(fmt::format("W{}", k), {x[0] - kArm, y[k]}, 0.0);
    maker.node(fmt::format("E{}", k), {x[2] + kArm, y[k]}, 0.0);
    maker.node(fmt::format("S{}", k), {x[k], y[0] - kArm}, 0.0);
    maker.node(fmt::format("N{}", k), {x[k], y[2] + kArm}, 0.0);
    add_arms(maker, name(0, int(k)), {fmt::format("W{}", k)}, 1, shape);
    add_arms(maker, name(2, int(k)), {fmt::format("E{}", k)}, 1, shape);
    add_arms(maker, name(int(k), 0), {fmt::format("S{}", k)}, 1, shape);
    add_arms(maker, name(int(k), 2), {fmt::format("N{}", k)}, 1, shape);
  }
  shape.network = maker.make();
  return shape;
}

NetworkShape t_shape(double radius) {
  NetworkShape shape{.name = "t"};
  NetworkMaker maker;
  maker.node("C", {0, 0}, radius);
  maker.node("W", {-120, 0}, 0.0);
  maker.node("E", {120, 0}, 0.0);
  maker.node("S", {0, -120}, 0.0);
  add_arms(maker, "C", {"W", "E", "S"}, 1, shape);
  shape.network = maker.make();
  return shape;
}

NetworkShape five_arms_shape() {
  NetworkShape shape{.name = "five_arms"};
  NetworkMaker maker;
  maker.node("C", {0, 0}, 11.0);
  std::vector<std::string> ends;
  for (int k = 0; k < 5; ++k) {
    const double a = 2.0 * kPi * k / 5.0 + 0.3;
    ends.push_back(fmt::format("P{}", k));
    maker.node(ends.back(), {120.0 * std::cos(a), 120.0 * std::sin(a)}, 0.0);
  }
  add_arms(maker, "C", ends, 1, shape);
  shape.network = maker.make();
  return shape;
}

NetworkShape roundabout_shape() {
  NetworkShape shape{.name = "roundabout"};
  NetworkMaker maker;
  constexpr double kRing = 18.0;
  const auto on_ring = [&](double quarter) {
    return Point{kRing * std::cos(quarter * kPi / 2), kRing * std::sin(quarter * kPi / 2)};
  };
  for (int k = 0; k < 4; ++k) maker.node(fmt::format("R{}", k), on_ring(k), 6.0);
  for (int k = 0; k < 4; ++k) {
    const std::string ring = fmt::format("R{}", k);
    const std::string end = fmt::format("P{}", k);
    std::vector<Point> between;
    for (int i = 1; i < 12; ++i) between.push_back(on_ring(k + i / 12.0));
    maker.one_way(ring, fmt::format("R{}", (k + 1) % 4), 1, between);
    const Point direction = on_ring(k);
    maker.node(end, {direction.x * 130.0 / kRing, direction.y * 130.0 / kRing}, 0.0);
    add_arms(maker, ring, {end}, 1, shape);
  }
  shape.network = maker.make();
  return shape;
}

NetworkShape chain_shape(double radius, double apart) {
  NetworkShape shape{.name = "chain"};
  NetworkMaker maker;
  maker.node("A", {0, 0}, radius);
  maker.node("B", {apart, 0}, radius);
  maker.road("A", "B");
  maker.node("W", {-110, 0}, 0.0);
  maker.node("E", {apart + 110, 0}, 0.0);
  maker.node("NA", {0, 110}, 0.0);
  maker.node("SA", {0, -110}, 0.0);
  maker.node("NB", {apart, 110}, 0.0);
  maker.node("SB", {apart, -110}, 0.0);
  add_arms(maker, "A", {"W", "NA", "SA"}, 1, shape);
  add_arms(maker, "B", {"E", "NB", "SB"}, 1, shape);
  shape.network = maker.make();
  return shape;
}

NetworkShape two_lanes_shape() {
  NetworkShape shape{.name = "two_lanes"};
  NetworkMaker maker;
  maker.node("C", {0, 0}, 12.0);
  for (int k = 0; k < 4; ++k) {
    maker.node(kArms[std::size_t(k)], turned({-150.0, 0.0}, k), 0.0);
  }
  add_arms(maker, "C", {"W", "S", "E", "N"}, 2, shape);
  for (std::size_t k = 0; k < 4; ++k) {
    const std::string in = kArms[k] + "-C_";
    const auto out = [&](std::size_t quarters) { return "C-" + kArms[(k + quarters) % 4] + "_"; };
    maker.connect(in + "0", out(1) + "0");
    maker.connect(in + "0", out(2) + "0");
    maker.connect(in + "1", out(3) + "1");
  }
  shape.network = maker.make();
  return shape;
}

NetworkShape left_hand_shape() {
  NetworkShape shape = crossroads_shape();
  shape.name = "left_hand";
  shape.network = mirrored(std::move(shape.network));
  return shape;
}

NetworkShape short_arms_shape() {
  NetworkShape shape{.name = "short_arms"};
  NetworkMaker maker;
  maker.node("C", {0, 0});
  const std::array<double, 4> arms = {20.0, 16.0, 12.0, 9.0};
  for (std::size_t k = 0; k < 4; ++k) {
    maker.node(kArms[k], turned({-7.2 - arms[k], 0.0}, int(k)), 0.0);
  }
  add_arms(maker, "C", {"W", "S", "E", "N"}, 1, shape);
  shape.network = maker.make();
  return shape;
}

NetworkShape bend_behind_shape(double behind, bool marked) {
  NetworkShape shape{.name = "bend_behind"};
  NetworkMaker maker;
  maker.node("W", {-150.0, 0.0}, 0.0);
  maker.node("S", {0.0, -150.0}, 0.0);
  maker.node("N", {0.0, 150.0}, 0.0);
  maker.node("A", {0.0, 0.0});
  maker.node("B", {7.2 + behind + 7.2, 0.0});
  maker.node("E", {7.2 + behind + 7.2, 200.0}, 0.0);
  maker.one_way("W", "A");
  maker.one_way("S", "A");
  maker.one_way("A", "N");
  maker.one_way("A", "B");
  maker.one_way("B", "E");
  if (marked) maker.limit_bends(5.0);
  shape.network = maker.make();
  return shape;
}

NetworkShape u_turn_shape() {
  NetworkShape shape{.name = "u_turn"};
  NetworkMaker maker;
  maker.node("C", {0, 0});
  maker.node("W", {-120, 0}, 0.0);
  maker.node("E", {120, 0}, 0.0);
  maker.node("S", {0, -120}, 0.0);
  add_arms(maker, "C", {"W", "E", "S"}, 1, shape);
  for (const std::string from : {"W", "E", "S"}) {
    for (const std::string to : {"W", "E", "S"}) maker.connect(from + "-C_0", "C-" + to + "_0");
  }
  shape.network = maker.make();
  return shape;
}

NetworkShape seam_shape(Point west, Point seam, double radius) {
  NetworkShape shape{.name = "seam"};
  NetworkMaker maker;
  maker.node("C", {0, 0});
  maker.node("D", seam, radius);
  maker.node("W", west, 0.0);
  maker.node("S", {0, -110}, 0.0);
  maker.node("E", {110, 0}, 0.0);
  maker.node("N", {0, 110}, 0.0);
  maker.road("D", "C");
  add_arms(maker, "D", {"W"}, 1, shape);
  add_arms(maker, "C", {"S", "E", "N"}, 1, shape);
  shape.network = maker.make();
  return shape;
}

NetworkShape fork_shape() {
  NetworkShape shape{.name = "fork"};
  NetworkMaker maker;
  maker.node("C", {0, 0});
  maker.node("D", {-42, 0}, 9.0);
  maker.node("X", {-140, 0}, 0.0);
  maker.node("Y", {-110, 75}, 0.0);
  maker.node("S", {0, -110}, 0.0);
  maker.node("E", {110, 0}, 0.0);
  maker.node("N", {0, 110}, 0.0);
  maker.one_way("C", "D");
  for (const std::string end : {"X", "Y"}) {
    maker.one_way("D", end);
    shape.sinks.push_back("D-" + end);
  }
  add_arms(maker, "C", {"S", "E", "N"}, 1, shape);
  shape.network = maker.make();
  return shape;
}

NetworkShape with_signals(NetworkShape shape) {
  for (auto& [id, junction] : shape.network.junctions) {
    if (!junction.has_conflicts) continue;
    int lights = 0;
    for (Connection& c : junction.connections) {
      c.signal = id;
      c.signal_index = lights++;
    }
    shape.network.signals[id] = lights;
  }
  return shape;
}

NetworkShape crossroads_with_phases() {
  NetworkShape shape = with_signals(crossroads_shape());
  const std::string left_of = "WNESW";  // where a left-turner from each arm goes
  for (const std::string arms : {"WE", "SN"}) {
    SignalPhase phase{.duration = 30.0, .least = 5.0, .most = 50.0, .lights = {}};
    for (const Connection& c : shape.network.junctions.at("C").connections) {
      const char from = c.from_lane.front();
      const char to = c.to_lane[c.to_lane.find('-') + 1];
      const bool left = left_of[left_of.find(from) + 1] == to;
      const bool green = arms.find(from) != std::string::npos;
      phase.lights += !green ? 'r' : left ? 'g' : 'G';
    }
    shape.programs["C"].push_back(std::move(phase));
  }
  return shape;
}

NetworkShape with_crossings(NetworkShape shape) {
  constexpr double kWidth = 4.0;   // [m]
  constexpr double kCorner = 6.0;  // [m] between the ends of crossings that share a walking area
  for (auto& [id, junction] : shape.network.junctions) {
    if (!junction.has_conflicts) continue;
    std::vector<std::pair<Point, std::string>> corners;
    const auto corner_at = [&](const Point& p) {
      for (const auto& [at, name] : corners) {
        if (std::hypot(p.x - at.x, p.y - at.y) < kCorner) return name;
      }
      return corners.emplace_back(p, ":" + id + "_w" + std::to_string(corners.size())).second;
    };
    for (const std::string& in : junction.incoming_lanes) {
      const Lane& lane = shape.network.lanes.at(in);
      const std::size_t dash = lane.edge.find('-');
      const auto back = shape.network.lanes.find(lane.edge.substr(dash + 1) + "-" +
                                                 lane.edge.substr(0, dash) + "_0");
      if (lane.index != 0 || back == shape.network.lanes.end()) continue;
      // From the right edge of the incoming lane to the right edge of the other.
      const Point a = lane.shape.back();
      const Point b = back->second.shape.front();
      const double apart = std::hypot(b.x - a.x, b.y - a.y);
      const Point across{(b.x - a.x) / apart, (b.y - a.y) / apart};
      const Point inwards{across.y, -across.x};
      const double kerb = lane.width / 2.0;
      PedestrianCrossing crossing{.id = ":" + id + "_c" + std::to_string(junction.crossings.size()),
                                  .width = kWidth,
                                  .has_priority = true};
      crossing.shape = {{a.x - kerb * across.x + kWidth / 2.0 * inwards.x,
                         a.y - kerb * across.y + kWidth / 2.0 * inwards.y},
                        {b.x + kerb * across.x + kWidth / 2.0 * inwards.x,
                         b.y + kerb * across.y + kWidth / 2.0 * inwards.y}};
      crossing.ends = {corner_at(crossing.shape.front()), corner_at(crossing.shape.back())};
      if (const auto signal = shape.network.signals.find(id);
          signal != shape.network.signals.end()) {
        crossing.signal = id;
        crossing.lights = {signal->second++};
      }
      junction.crossings.push_back(std::move(crossing));
    }
  }
  return shape;
}

NetworkShape fan_out_shape() {
  NetworkShape shape{.name = "fan_out"};
  NetworkMaker maker;
  maker.node("W", {-120, 0}, 0.0);
  maker.node("C", {0, 0});
  maker.node("E", {180, 0}, 0.0);
  maker.node("S", {0, -120}, 0.0);
  maker.road("C", "W");
  maker.one_way("C", "E", 2);
  maker.road("C", "S");
  maker.connect("W-C_0", "C-E_0");
  maker.connect("W-C_0", "C-E_1");
  maker.connect("W-C_0", "C-S_0");
  maker.connect("S-C_0", "C-W_0");
  maker.connect("S-C_0", "C-E_0");
  shape.network = maker.make();
  return shape;
}

const std::vector<NamedShape>& all_shapes() {
  static const std::vector<NamedShape> kAll = {{"crossroads", [] { return crossroads_shape(); }},
                                               {"grid", grid_shape},
                                               {"t", [] { return t_shape(); }},
                                               {"five_arms", five_arms_shape},
                                               {"roundabout", roundabout_shape},
                                               {"chain", [] { return chain_shape(); }},
                                               {"two_lanes", two_lanes_shape},
                                               {"left_hand", left_hand_shape},
                                               {"short_arms", short_arms_shape},
                                               {"seam", [] { return seam_shape(); }}};
  return kAll;
}

const std::vector<NamedShape>& roomy_shapes() {
  static const std::vector<NamedShape> kRoomy = {
      {"crossroads", [] { return crossroads_shape(120.0, 13.0); }},
      {"t", [] { return t_shape(13.0); }},
      {"five_arms", five_arms_shape},
      {"chain", [] { return chain_shape(13.0); }}};
  return kRoomy;
}

}  // namespace mvtp
