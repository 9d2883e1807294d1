#include "traci_bridge/network.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <ranges>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/network/polyline.hpp"
#include "traci_bridge/xml.hpp"

namespace mvtp {
namespace {

using Element = tinyxml2::XMLElement;

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::ranges::find(words, word) != words.end();
}

bool is_true(const std::string& text) { return text == "1" || text == "true" || text == "yes"; }

/// SUMO's classes of vehicles that drive on roads by a motor.
constexpr std::array kMotorClasses = {"passenger", "private", "taxi",    "bus",       "coach",
                                      "delivery",  "truck",   "trailer", "emergency", "authority",
                                      "army",      "vip",     "hov",     "evehicle",  "motorcycle",
                                      "moped",     "custom1", "custom2"};

// Whatever is looked up by its place takes memory by the metre.
constexpr double kLongestLane = 100'000.0;   // [m]
constexpr double kWidestLane = 1'000.0;      // [m]: waterways are wide
constexpr double kLongestBorder = 10'000.0;  // [m] of a junction
constexpr double kFarthest = 1e8;            // [m] from the origin: any projection of the Earth

/// Twice the signed area of the triangle a, b, c.
double turn(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool segments_cross(const Point& a, const Point& b, const Point& c, const Point& d) {
  return turn(a, b, c) * turn(a, b, d) <= 0.0 && turn(c, d, a) * turn(c, d, b) <= 0.0 &&
         std::max(a.x, b.x) >= std::min(c.x, d.x) && std::max(c.x, d.x) >= std::min(a.x, b.x) &&
         std::max(a.y, b.y) >= std::min(c.y, d.y) && std::max(c.y, d.y) >= std::min(a.y, b.y);
}

bool lines_cross(const std::vector<Point>& p, const std::vector<Point>& q) {
  for (std::size_t i = 1; i < p.size(); ++i) {
    for (std::size_t j = 1; j < q.size(); ++j) {
      if (segments_cross(p[i - 1], p[i], q[j - 1], q[j])) return true;
    }
  }
  return false;
}

class NetworkReader {
 public:
  NetworkReader(const std::string& path, const InterruptionPoint& point)
      : file_(path, "a SUMO network, *.net.xml"), point_(point) {}

  RoadNetwork read() {
    const Element& root = file_.root();
    if (std::string(root.Name()) != "net") {
      file_.fail(root, std::string("the root element is <") + root.Name() +
                           ">, not <net>; give the path of a SUMO network, *.net.xml");
    }
    network_.left_hand = is_true(attribute(root, "lefthand"));
    for (const Element* edge : children(root, "edge")) add_edge(*edge);
    if (network_.edges.empty())
      file_.fail(root, "a network without edges; make it with netconvert");
    for (const Element* junction : children(root, "junction")) add_junction(*junction);
    add_connections(children(root, "connection"));
    place_crossings(children(root, "junction"));
    for (Junction& junction : std::views::values(network_.junctions)) {
      point_();
      junction.has_conflicts = has_conflicts(junction);
    }
    return std::move(network_);
  }

 private:
  void add_edge(const Element& element) {
    point_();
    const std::string function = attribute(element, "function");
    if (function == "crossing") add_crossing(element);
    if (function == "crossing" || function == "walkingarea") return;

    const std::string id = file_.text(element, "id");
    std::vector<std::string>& lanes = lanes_of_edge_[id];
    if (!lanes.empty()) file_.fail(element, "edge \"" + id + "\" is defined twice");
    for (const Element* lane : children(element, "lane")) {
      lanes.push_back(add_lane(*lane, id, function == "internal"));
    }
    if (lanes.empty()) file_.fail(element, "edge \"" + id + "\" has no lanes");
    if (function == "internal") return;
    network_.edges[id] = lanes;
    end_of_edge_[id] = file_.text(element, "to");
  }

  void check_size(const Element& element, const std::string& name, const char* how, double size,
                  double most) const {
    if (size <= most) return;
    file_.fail(element, fmt::format("{} is {:g} m {}, more than {:g} m; correct the network", name,
                                    size, how, most));
  }

  void check_place(const Element& element, const std::string& name,
                   const std::vector<Point>& shape) const {
    for (const Point& p : shape) {
      if (std::abs(p.x) <= kFarthest && std::abs(p.y) <= kFarthest) continue;
      file_.fail(element, fmt::format("{} lies at ({:g}, {:g}), more than {:g} m from the origin; "
                                      "correct the network",
                                      name, p.x, p.y, kFarthest));
    }
  }

  std::string add_lane(const Element& element, const std::string& edge, bool internal) {
    Lane lane{.id = file_.text(element, "id"),
              .edge = edge,
              .index = file_.index(element, "index"),
              .speed_limit = file_.positive(element, "speed"),
              .length = file_.positive(element, "length"),
              .width = file_.positive(element, "width", 3.2),
              .internal = internal,
              .shape = file_.points(element, "shape"),
              .allowed = split(attribute(element, "allow"), " "),
              .banned = split(attribute(element, "disallow"), " ")};
    lane.drivable = lane.allows("passenger");
    lane.road = std::ranges::any_of(kMotorClasses, [&](const char* c) { return lane.allows(c); });
    lane.footpath = lane.allowed == std::vector<std::string>{"pedestrian"};
    network_.opposite_lanes |= element.FirstChildElement("neigh") != nullptr;
    if (lane.shape.size() < 2) file_.fail(element, "lane \"" + lane.id + "\" has no shape");
    const std::string name = "lane \"" + lane.id + "\"";
    check_size(element, name, "long", std::max(lane.length, length_of(lane.shape)), kLongestLane);
    check_size(element, name, "wide", lane.width, kWidestLane);
    check_place(element, name, lane.shape);
    if (lane.index != static_cast<int>(lanes_of_edge_[edge].size())) {
      file_.fail(element, "lane \"" + lane.id + "\" is not the next of its edge");
    }
    const std::string id = lane.id;
    if (!network_.lanes.emplace(id, std::move(lane)).second) {
      file_.fail(element, "lane \"" + id + "\" is defined twice");
    }
    return id;
  }

  void add_crossing(const Element& element) {
    const Element* lane = element.FirstChildElement("lane");
    const std::string id = file_.text(element, "id");
    if (lane == nullptr) file_.fail(element, "crossing \"" + id + "\" has no lane");
    PedestrianCrossing crossing{.id = id,
                                .width = file_.positive(*lane, "width", 4.0),
                                .shape = file_.points(*lane, "shape"),
                                .lights = {}};
    const auto repeated = std::ranges::unique(crossing.shape);
    crossing.shape.erase(repeated.begin(), repeated.end());
    if (crossing.shape.size() < 2) file_.fail(*lane, "crossing \"" + id + "\" has no shape");
    crossings_.insert_or_assign(id, std::move(crossing));
  }

  /// A connection onto a crossing says what people obey who enter it there, one that leads off it
  /// what those do who come the other way.
  void add_rule(const Element& element) {
    const auto onto = crossings_.find(file_.text(element, "to"));
    const auto off = crossings_.find(file_.text(element, "from"));
    if (onto == crossings_.end() && off == crossings_.end()) return;
    PedestrianCrossing& crossing = (onto != crossings_.end() ? onto : off)->second;
    if (onto != crossings_.end()) crossing.has_priority = attribute(element, "state") == "M";
    crossing.ends.push_back(file_.text(element, onto != crossings_.end() ? "from" : "to"));
    const auto light = light_of(element);
    if (!light) return;
    crossing.signal = light->signal;
    crossing.lights.push_back(light->index);
  }

  /// The lanes inside a junction name its crossings too.
  void place_crossings(const std::vector<const Element*>& junctions) {
    for (const Element* element : junctions) {
      const auto junction = network_.junctions.find(file_.text(*element, "id"));
      if (junction == network_.junctions.end()) continue;
      for (const std::string& lane : split(attribute(*element, "intLanes"), " ")) {
        const auto crossing = crossings_.find(lane.substr(0, lane.rfind('_')));
        if (crossing != crossings_.end()) junction->second.crossings.push_back(crossing->second);
      }
    }
  }

  void add_junction(const Element& element) {
    point_();
    Junction junction{.id = file_.text(element, "id"),
                      .type = file_.text(element, "type"),
                      .position = {file_.number(element, "x"), file_.number(element, "y")},
                      .shape = {},
                      .incoming_lanes = {},
                      .connections = {},
                      .crossings = {},
                      .has_conflicts = false};
    if (junction.type == "internal") return;  // a place to wait inside another junction
    if (element.Attribute("shape") != nullptr) junction.shape = file_.points(element, "shape");
    if (junction.shape.size() > 1 && junction.shape.front() == junction.shape.back()) {
      junction.shape.pop_back();
    }
    const std::string name = "junction \"" + junction.id + "\"";
    check_size(element, name, "around", length_of(junction.shape), kLongestBorder);
    check_place(element, name, junction.shape);
    for (const std::string& lane : split(attribute(element, "incLanes"), " ")) {
      if (network_.lanes.contains(lane) && !network_.lanes.at(lane).internal) {
        junction.incoming_lanes.push_back(lane);
      }
    }
    const std::string id = junction.id;
    network_.junctions.emplace(id, std::move(junction));
  }

  /// A connection leads from a lane into the junction and names the first internal lane; that
  /// one has a connection of its own to the same end, which may name a second, and so on.
  void add_connections(const std::vector<const Element*>& elements) {
    std::map<std::pair<std::string, std::string>, std::string> next;  // (internal, to) -> via
    for (const Element* element : elements) {
      if (!between_known_edges(*element)) continue;
      const auto [from, to] = ends(*element);
      const std::string via = attribute(*element, "via");
      if (network_.lanes.at(from).internal && !via.empty()) next[{from, to}] = via;
    }
    for (const Element* element : elements) {
      point_();
      count_light(*element);
      add_rule(*element);
      if (!between_known_edges(*element)) continue;
      const auto [from, to] = ends(*element);
      if (network_.lanes.at(from).internal) continue;
      Connection connection{.from_lane = from, .via = {}, .to_lane = to};
      if (const auto light = light_of(*element)) {
        connection.signal = light->signal;
        connection.signal_index = light->index;
      }
      std::string via = attribute(*element, "via");
      while (!via.empty()) {
        if (!network_.lanes.contains(via) || contains(connection.via, via)) {
          file_.fail(*element, "the internal lanes from \"" + from + "\" to \"" + to +
                                   "\" do not end: \"" + via + "\"");
        }
        connection.via.push_back(via);
        const auto following = next.find({via, to});
        via = following == next.end() ? "" : following->second;
      }
      junction_behind(*element, from).connections.push_back(std::move(connection));
    }
  }

  struct Light {
    std::string signal;
    int index = 0;
  };

  /// The signal head that a connection obeys; none too at a signal that does not control it, which
  /// SUMO writes as the index -1.
  std::optional<Light> light_of(const Element& element) const {
    const std::string signal = attribute(element, "tl");
    if (signal.empty() || attribute(element, "linkIndex") == "-1") return std::nullopt;
    return Light{signal, file_.index(element, "linkIndex")};
  }

  /// Lights are numbered from 0 on; connections of footpaths have some too.
  void count_light(const Element& element) {
    const auto light = light_of(element);
    if (!light) return;
    int& lights = network_.signals[light->signal];
    lights = std::max(lights, light->index + 1);
  }

  /// False for connections of footpaths.
  bool between_known_edges(const Element& element) const {
    return lanes_of_edge_.contains(file_.text(element, "from")) &&
           lanes_of_edge_.contains(file_.text(element, "to"));
  }

  std::pair<std::string, std::string> ends(const Element& element) const {
    return {end(element, "from", "fromLane"), end(element, "to", "toLane")};
  }

  std::string end(const Element& element, const char* edge, const char* index) const {
    const std::vector<std::string>& lanes = lanes_of_edge_.at(file_.text(element, edge));
    const auto i = static_cast<std::size_t>(file_.index(element, index));
    if (i >= lanes.size()) {
      file_.fail(element,
                 "edge \"" + file_.text(element, edge) + "\" has no lane " + std::to_string(i));
    }
    return lanes[i];
  }

  Junction& junction_behind(const Element& element, const std::string& lane) {
    const std::string& id = end_of_edge_.at(network_.lanes.at(lane).edge);
    const auto junction = network_.junctions.find(id);
    if (junction == network_.junctions.end()) {
      file_.fail(element, "there is no junction \"" + id + "\" at the end of lane \"" + lane + '"');
    }
    return junction->second;
  }

  /// By anybody with a motor: a bus that comes out of its own lane meets all others.
  bool drivable(const Connection& c) const {
    return network_.lanes.at(c.from_lane).road && network_.lanes.at(c.to_lane).road;
  }

  /// The centre line inside the junction.
  std::vector<Point> centre_line(const Connection& c) const {
    std::vector<Point> line;
    for (const std::string& lane : c.via) {
      const std::vector<Point>& shape = network_.lanes.at(lane).shape;
      line.insert(line.end(), shape.begin(), shape.end());
    }
    if (line.empty()) {
      line = {network_.lanes.at(c.from_lane).shape.back(),
              network_.lanes.at(c.to_lane).shape.front()};
    }
    return line;
  }

  /// Conflicts are judged by geometry: SUMO's own table of foes is empty where nobody yields.
  bool has_conflicts(const Junction& junction) const {
    std::vector<const Connection*> open;
    std::vector<std::vector<Point>> lines;
    for (const Connection& c : junction.connections) {
      if (!drivable(c)) continue;
      open.push_back(&c);
      lines.push_back(centre_line(c));
    }
    for (std::size_t i = 0; i < open.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (open[i]->from_lane == open[j]->from_lane) continue;
        if (open[i]->to_lane == open[j]->to_lane || lines_cross(lines[i], lines[j])) return true;
      }
    }
    return false;
  }

  XmlFile file_;
  const InterruptionPoint& point_;
  RoadNetwork network_;
  std::map<std::string, std::vector<std::string>> lanes_of_edge_;  ///< internal edges too
  std::map<std::string, PedestrianCrossing> crossings_;            ///< by id
  std::map<std::string, std::string> end_of_edge_;                 ///< its junction; normal edges
};

}  // namespace

RoadNetwork read_network(const std::string& path, const InterruptionPoint& point) {
  return NetworkReader(path, point).read();
}

}  // namespace mvtp
