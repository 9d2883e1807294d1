#include "coordinator/zone.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

constexpr double kLeadIn = 30.0;        ///< [m] of path before the zone, for bodies that reach back
constexpr double kRunOut = 25.0;        ///< [m] of path behind the hand-back
constexpr double kBeforeLaneEnd = 9.0;  ///< [m] that a hand-back keeps from the end of its lane

/// The centre lines of the lanes one after another, without repeated points.
std::vector<Point> centre_line(const RoadNetwork& network, const std::vector<std::string>& lanes) {
  std::vector<Point> line;
  for (const std::string& id : lanes) {
    for (const Point& p : network.lanes.at(id).shape) {
      if (line.empty() || std::hypot(p.x - line.back().x, p.y - line.back().y) > 1e-3) {
        line.push_back(p);
      }
    }
  }
  return line;
}

/// The line without its first `length` metres; continued straight backwards if that is negative.
std::vector<Point> trimmed(std::vector<Point> line, double length) {
  const auto between = [](const Point& a, const Point& b, double f) -> Point {
    return {a.x + f * (b.x - a.x), a.y + f * (b.y - a.y)};
  };
  while (line.size() > 2) {
    const double first = std::hypot(line[1].x - line[0].x, line[1].y - line[0].y);
    if (length < first) break;
    length -= first;
    line.erase(line.begin());
  }
  const double first = std::hypot(line[1].x - line[0].x, line[1].y - line[0].y);
  line[0] = between(line[0], line[1], std::min(length / first, 0.99));
  return line;
}

/// The line without its last `length` metres; whole if that is negative.
std::vector<Point> shortened(std::vector<Point> line, double length) {
  if (length <= 0.0) return line;
  std::ranges::reverse(line);
  line = trimmed(std::move(line), length);
  std::ranges::reverse(line);
  return line;
}

double shape_length(const Lane& lane) {
  double length = 0.0;
  for (std::size_t i = 1; i < lane.shape.size(); ++i) {
    length +=
        std::hypot(lane.shape[i].x - lane.shape[i - 1].x, lane.shape[i].y - lane.shape[i - 1].y);
  }
  return length;
}

}  // namespace

Zone::Zone(const RoadNetwork& network, const DrivableArea& area,
           const std::set<std::string>& junctions, const ZoneOptions& options)
    : network_(network),
      area_(area),
      junctions_(junctions),
      options_(options),
      library_(options.margins) {
  for (const std::string& id : junctions) {
    if (!network.junctions.contains(id)) {
      throw InputError("--junction " + id, "the network has no junction with this id");
    }
  }
  for (const auto& [id, junction] : network.junctions) {
    for (const Connection& c : junction.connections) {
      connections_[c.from_lane].push_back(&c);
      junction_ahead_[c.from_lane] = id;
      if (!junctions.contains(id)) continue;
      zone_lanes_.insert(c.from_lane);
      zone_lanes_.insert(c.to_lane);
      zone_lanes_.insert(c.via.begin(), c.via.end());
    }
  }
}

bool Zone::is_approaching(const VehicleState& vehicle) const {
  const auto ahead = junction_ahead_.find(vehicle.lane);
  return ahead != junction_ahead_.end() && junctions_.contains(ahead->second) &&
         lane(vehicle.lane).length - vehicle.lane_position <= options_.radius;
}

bool Zone::leads_on(const std::string& from, std::span<const std::string> route) const {
  if (route.empty()) return true;
  const auto out = connections_.find(from);
  return out != connections_.end() && std::ranges::any_of(out->second, [&](const Connection* c) {
           return lane(c->to_lane).edge == route[0];
         });
}

/// Appends the lanes of `route` behind lanes.back() until `beyond` metres lie behind the last
/// coordinated junction; prefers lanes from which the route goes on. False if no lane leads there.
bool Zone::extend(Lanes& lanes, std::span<const std::string> route, double beyond) const {
  const Lane& last = lane(lanes.back());
  const auto ahead = junction_ahead_.find(last.id);
  const bool at_coordinated = ahead != junction_ahead_.end() && junctions_.contains(ahead->second);
  const bool first = lanes.size() == 1;
  // Behind the last junction: enough road, or the end of the route, or a junction of others.
  const bool covered = at_coordinated && last.length <= options_.radius + options_.exit;
  if (!first && !covered) {
    const double left = beyond - last.length;
    const bool foreign = ahead != junction_ahead_.end() && !at_coordinated &&
                         network_.junctions.at(ahead->second).has_conflicts;
    if (left <= 0.0 || route.empty() || at_coordinated || (foreign && last.length >= 20.0))
      return true;
    beyond = left;
  } else {
    beyond = options_.exit + kRunOut;
  }
  if (route.empty()) return !first;

  const auto out = connections_.find(last.id);
  if (out == connections_.end()) return !first;
  for (const bool must_lead_on : {true, false}) {
    for (const Connection* c : out->second) {
      if (lane(c->to_lane).edge != route[0]) continue;
      if (must_lead_on != leads_on(c->to_lane, route.subspan(1))) continue;
      Lanes longer = lanes;
      longer.insert(longer.end(), c->via.begin(), c->via.end());
      longer.push_back(c->to_lane);
      if (!extend(longer, route.subspan(1), beyond)) continue;
      lanes = std::move(longer);
      return true;
    }
  }
  return !first && !covered;
}

std::optional<int> Zone::movement_for(const VehicleState& vehicle,
                                      std::span<const std::string> route, const VehicleType& type) {
  if (route.size() < 2 || !is_approaching(vehicle)) return std::nullopt;
  Lanes lanes = {vehicle.lane};
  if (!extend(lanes, route.subspan(1), 0.0)) return std::nullopt;
  return movement_along(lanes, type);
}

std::optional<int> Zone::movement_over(const std::string& id, const VehicleType& type) {
  std::optional<Lanes> lanes;
  for (const auto& [key, m] : known_) {
    if (std::ranges::find(key.first, id) == key.first.end()) continue;
    if (key.second == type.id) return m;
    if (!lanes) lanes = key.first;
  }
  if (!lanes) return std::nullopt;
  return movement_along(*lanes, type);
}

int Zone::movement_along(const Lanes& lanes, const VehicleType& type) {
  const auto [entry, is_new] = known_.try_emplace({lanes, type.id}, int(movements_.size()));
  if (is_new) movements_.push_back(build(lanes, type));
  return entry->second;
}

int Zone::number_of(const std::string& id) {
  return lane_numbers_.try_emplace(id, int(lane_numbers_.size())).first->second;
}

/// The lane behind the last coordinated junction.
std::string Zone::exit_lane_of(const Lanes& lanes) const {
  std::string exit = lanes.back();
  std::string before;
  for (const std::string& id : lanes) {
    if (lane(id).internal) continue;
    if (!before.empty() && junctions_.contains(junction_ahead_.at(before))) exit = id;
    before = id;
  }
  return exit;
}

/// Length of the lanes from the start of `exit` on.
double Zone::length_behind(const Lanes& lanes, const std::string& exit) const {
  double length = 0.0;
  for (auto id = std::ranges::find(lanes, exit); id != lanes.end(); ++id) {
    length += shape_length(lane(*id));
  }
  return length;
}

/// The speed at s that keeps to the limit [m/s]. Speeds are looked up at a few places of each decision
/// only: the sharpest bend nearby counts, with a little to spare.
double Zone::lateral_limit(const GuidePath& path, double s) const {
  constexpr double kNearby = 0.75;  // [m]
  constexpr double kSpare = 0.97;
  double sharpest = 1e-9;
  for (double d = -kNearby; d <= kNearby; d += GuidePath::kSpacing) {
    sharpest = std::max(sharpest, std::abs(path.curvature(s + d)));
  }
  return options_.max_lateral_accel > 0.0
             ? std::sqrt(kSpare * options_.max_lateral_accel / sharpest)
             : std::numeric_limits<double>::infinity();
}

Movement Zone::build(const Lanes& lanes, const VehicleType& type) {
  const double before = std::min(shape_length(lane(lanes[0])) - options_.radius - kLeadIn, 0.0);
  const double skipped = std::max(shape_length(lane(lanes[0])) - options_.radius - kLeadIn, before);
  const std::string exit = exit_lane_of(lanes);
  const double used = options_.exit + kRunOut + kBeforeLaneEnd + 2.0 * type.body.length();
  const std::vector<Point> line =
      shortened(trimmed(centre_line(network_, lanes), skipped), length_behind(lanes, exit) - used);
  GuidePath path = make_guide_path(line, type.body, area_);

  Movement m;
  m.lanes = lanes;
  m.type = type.id;
  double from = 0.0;
  std::vector<std::pair<double, double>> limits;  // of each lane: from here on, this
  for (const std::string& id : lanes) {
    const Lane& l = lane(id);
    const double start = id == lanes[0] ? -skipped : path.project(l.shape[0], from, path.length());
    from = std::max(start, 0.0);
    m.lane_starts[id] = start - type.body.front;
    limits.emplace_back(start, l.speed_limit);
  }
  m.entry_lane = number_of(lanes[0]);
  m.exit_lane = number_of(exit);
  m.s_entry_line = m.lane_starts.at(lanes[1]);
  m.s_exit_lane = m.lane_starts.at(exit);
  m.s_end = path.length() - type.body.front - 1.0;
  const double latest = path.length() - type.body.front - kBeforeLaneEnd;
  m.s_handback = std::min({m.s_exit_lane + options_.exit, latest, m.s_end});
  m.s_end = std::min(m.s_end, m.s_handback + kRunOut);

  for (std::size_t i = 0; i < path.samples(); ++i) {
    const double s = double(i) * GuidePath::kSpacing;
    double limit = limits[0].second;
    for (const auto& [start, speed] : limits) {
      if (s + type.body.front >= start) limit = speed;
    }
    m.lane_limits.push_back(limit);
    m.lateral_limits.push_back(lateral_limit(path, s));
  }
  m.path = library_.add(std::move(path), type.body);
  return m;
}

}  // namespace mvtp
