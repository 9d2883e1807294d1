// How vehicles come under control of a coordinator.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "coordinator/audit/audit.hpp"
#include "coordinator/drivers/human_drivers.hpp"
#include "coordinator/junctions/coordinator.hpp"

namespace mvtp {
namespace {

constexpr double kSpareRoom = 10.0;  ///< [m] before a line, beside what it takes to stop there

/// The classes of road vehicles; what runs on rails, on foot or on two wheels without an engine
/// stays human-driven.
bool is_car_like(const std::string& vehicle_class) {
  constexpr std::array<std::string_view, 12> kNot = {
      "pedestrian",    "bicycle", "tram",      "rail",      "rail_urban", "rail_fast",
      "rail_electric", "ship",    "container", "cable_car", "subway",     "aircraft"};
  return std::ranges::find(kNot, vehicle_class) == kNot.end();
}

}  // namespace

/// May it be taken over later? It has room to stop before its line.
bool Coordinator::can_wait(double speed, const Vehicle& body, double to_line) {
  return to_line >= stopping_distance(speed, comfortable_braking(body)) + kSpareRoom;
}

/// Tells the traffic along which edges the vehicle will be placed.
void Coordinator::announce(const std::string& id, const Driven& driven) {
  std::vector<std::string> edges;
  const CorridorCourse& course = corridors_[driven.corridor].course;
  if (graph_.edge_of(course.pieces.front().lane) == LaneGraph::kNone) {
    edges.push_back(graph_.edge_id(driven.route.front()));
  }
  for (const CorridorPiece& piece : course.pieces) {
    const int edge = graph_.edge_of(piece.lane);
    if (edge != LaneGraph::kNone) edges.push_back(graph_.edge_id(edge));
  }
  traffic_.drive_along(id, edges);
}

/// The corridor through the next junctions, for a vehicle near the end of its own; nullopt if there
/// is none for it, or no stop line near. @pre it is not inside
std::optional<Coordinator::Newcomer> Coordinator::next_corridor(const Driven& driven,
                                                                const VehicleState& state) {
  const Corridor& corridor = corridors_[driven.corridor];
  const double s = here(driven).s;
  const std::size_t at = corridor.piece_at(s);
  const CorridorPiece& piece = corridor.course.pieces[at];
  // How many edges of the route lie behind.
  std::size_t done =
      graph_.edge_of(corridor.course.pieces.front().lane) == LaneGraph::kNone ? 1 : 0;
  for (std::size_t i = 0; i < at; ++i) {
    done += graph_.edge_of(corridor.course.pieces[i].lane) != LaneGraph::kNone ? 1 : 0;
  }
  std::vector<int> route(driven.route.begin() + std::ptrdiff_t(std::min(done, driven.route.size())),
                         driven.route.end());
  CourseQuery query = query_for(state, route);
  query.lane = piece.last_lane();
  query.position = (s - corridor.stations[at]) / corridor.scales[at];
  std::optional<Newcomer> next = newcomer_at(state, query, route);
  if (!next) return std::nullopt;
  // What its body cannot drive is its driver's: it is taken over again behind that.
  const Corridor& ahead = corridors_[next->corridor];
  if (ahead.lines.front() - next->to_line < ahead.s_drivable) return std::nullopt;
  return next;
}

/// Why it is left to its driver; empty: it is not. Where drivers wait in the lane beside it, a body
/// that swings out before its turn would wait for them, and they for it.
std::string Coordinator::why_undriven(const Corridor& corridor) const {
  constexpr double kSwings = 1.0;  // [m] before its line
  if (!corridor.undriven.empty() || !owns_signals()) return corridor.undriven;
  for (std::size_t i = 0; i < corridor.lines.size(); ++i) {
    const int lane = corridor.course.pieces[std::size_t(corridor.course.lines[i])].last_lane();
    const bool is_alone = graph_.lanes_of(graph_.edge_of(lane)).size() < 2;
    if (!is_alone && corridor.lines[i] - corridor.stops[i] > kSwings) {
      return "the body would swing into the lane beside it, where human drivers wait";
    }
  }
  return {};
}

std::optional<Coordinator::Newcomer> Coordinator::newcomer_at(const VehicleState& state,
                                                              CourseQuery query,
                                                              std::vector<int> route) {
  query.edges = route;
  const std::optional<CorridorCourse> course = finder_.find(query);
  if (!course) return std::nullopt;
  const VehicleType& type = type_of(state.type);
  const int number = corridors_.corridor_for(*course, type.body);
  const Corridor& corridor = corridors_[number];
  const std::string undriven = why_undriven(corridor);
  if (!undriven.empty()) {
    const auto& pieces = corridor.course.pieces;
    undriven_.try_emplace(
        fmt::format("type {} from lane {} to lane {}", type.id,
                    graph_.lane(pieces[std::size_t(corridor.course.lines.front())].last_lane()).id,
                    graph_.lane(corridor.exit_lane).id),
        undriven);
    return std::nullopt;
  }
  const double s = corridor.station(query.lane, query.position, 0.0).value_or(0.0);
  if (s < corridor.s_drivable && !can_wait(state.speed, type.body, corridor.lines.front() - s)) {
    return std::nullopt;
  }
  if (!approach_to(corridor, state, s)
           .is_drivable(corridors_.library().path(corridor.path), type.body, area_)) {
    return std::nullopt;  // it stands too much askew, for now
  }
  predictor_.watch(corridor);
  return Newcomer{.state = &state,
                  .corridor = number,
                  .to_line = corridor.lines.front() - s,
                  .route = std::move(route)};
}

CourseQuery Coordinator::query_for(const VehicleState& v, std::span<const int> route) {
  const VehicleType& type = type_of(v.type);
  CourseQuery query{.lane = graph_.find_lane(v.lane),
                    .position = v.lane_position,
                    .edges = route,
                    .length = type.body.length(),
                    .vehicle_class = &type.vehicle_class};
  const auto trail = trails_.find(v.id);
  if (trail != trails_.end()) {
    const bool is_there = trail->second.lane == query.lane;
    query.previous_lane = is_there ? trail->second.before : trail->second.lane;
  }
  const bool has_choice = query.lane != LaneGraph::kNone && route.size() > 1 &&
                          graph_.links_between(query.lane, route[1]).size() > 1;
  if (has_choice) query.next_lane = graph_.find_lane(traffic_.next_lane(v.id));
  if (const std::optional<Stop> stop = traffic_.next_stop(v.id)) {
    const int edge = graph_.find_edge(stop->edge);
    const auto at = std::ranges::find(route, edge);
    if (at != route.end()) {
      query.stop_edge = std::size_t(at - route.begin());
      query.stop_lane = graph_.find_lane(stop->lane);
      query.stop_position = stop->position;
    }
  }
  return query;
}

std::vector<int> Coordinator::route_of(const VehicleState& v) const {
  std::vector<int> route;
  for (const std::string& edge : traffic_.route_edges(v.id)) {
    const int number = graph_.find_edge(edge);
    if (number == LaneGraph::kNone) break;
    route.push_back(number);
  }
  return route;
}

/// Which normal lanes vehicles have come over: their tails may still be there; and how long they
/// have stood.
void Coordinator::remember_lanes() {
  constexpr double kStanding = 0.1;  // [m/s]
  std::unordered_map<std::string, Trail> trails;
  for (const VehicleState& v : traffic_.vehicles()) {
    Trail trail;
    if (const auto known = trails_.find(v.id); known != trails_.end()) trail = known->second;
    const int lane = graph_.find_lane(v.lane);
    if (lane != LaneGraph::kNone && graph_.edge_of(lane) != LaneGraph::kNone &&
        lane != trail.lane) {
      const bool changed =
          trail.lane != LaneGraph::kNone && graph_.edge_of(lane) == graph_.edge_of(trail.lane);
      if (!changed) trail.before = trail.lane;
      trail.lane = lane;
    }
    if (lane != LaneGraph::kNone && predictor_.watches(lane)) trail.watched = v.pose;
    trail.stood = v.speed < kStanding ? trail.stood + 1 : 0;
    trails.emplace(v.id, trail);
  }
  trails_ = std::move(trails);
}

/// The normal lane that it is on, or was on before.
int Coordinator::came_from(const std::string& id) const {
  const auto trail = trails_.find(id);
  return trail == trails_.end() ? LaneGraph::kNone : trail->second.lane;
}

/// Is it on a lane that matters to those under control, or its tail still beside one, as it turns
/// off?
bool Coordinator::is_watched(const VehicleState& v) {
  constexpr double kFork = 15.0;  // [m] along which two lanes that part are beside each other
  const int lane = graph_.find_lane(v.lane);
  if (lane == LaneGraph::kNone) return false;
  if (predictor_.watches(lane)) return true;
  const auto trail = trails_.find(v.id);
  return trail != trails_.end() && trail->second.watched &&
         distance(*trail->second.watched, v.pose) < type_of(v.type).body.length() + kFork;
}

std::vector<Coordinator::Newcomer> Coordinator::find_newcomers() {
  std::vector<Newcomer> newcomers;
  gate_.begin();
  if (owns_signals()) humans_->begin(step_);
  for (const VehicleState& v : traffic_.vehicles()) {
    const int lane = graph_.find_lane(v.lane);
    if (lane == LaneGraph::kNone) continue;
    const bool passes = gate_.passes(v.id) || (humans_ && humans_->knows(v.id));
    if (!finder_.may_approach(lane, v.lane_position) && !passes) continue;
    if (driven_.contains(v.id) || traffic_.is_taken_over(v.id)) continue;
    if (v.halted_by_stop || is_entering(v)) continue;
    std::vector<int> route = route_of(v);
    const CourseQuery query = query_for(v, route);
    const std::string& vehicle_class = type_of(v.type).vehicle_class;
    const bool is_car = is_car_like(vehicle_class);
    if (!is_car) {
      undriven_.try_emplace("type " + v.type,
                            "class " + vehicle_class + " is not driven like a car");
    }
    std::optional<Newcomer> newcomer;
    if (is_car && options_.share.contains(v.id, v.type) && !touches_somebody(v)) {
      newcomer = newcomer_at(v, query, route);
    }
    const bool turns = newcomer && turns_yet(*newcomer);
    if (!newcomer || (turns && stands_for_good(v.id))) {
      see_guest(v, query);
      continue;
    }
    gate_.keep(v.id);
    if (!turns) newcomers.push_back(*std::move(newcomer));
  }
  gate_.end();
  if (owns_signals()) humans_->end();
  // Whoever is nearer to the line has arrived earlier; lanes keep their order this way.
  std::ranges::stable_sort(newcomers, {}, &Newcomer::to_line);
  return newcomers;
}

/// Does it enter the network just now, its tail still behind the beginning of its first lane?
/// Inside a junction its tail may be beside the road, too, but it has been seen before.
bool Coordinator::is_entering(const VehicleState& v) {
  if (graph_.edge_of(graph_.find_lane(v.lane)) == LaneGraph::kNone) return false;
  const double length = type_of(v.type).body.length();
  const auto trail = trails_.find(v.id);
  const bool came = trail != trails_.end() && trail->second.before != LaneGraph::kNone;
  return !came && v.lane_position < length + 3.0 &&
         area_.share_outside(v.pose, type_of(v.type).body, Audit::kRoadTolerance) > 0.0;
}

/// Does its body overlap another one, as those of two drivers may, or somebody on foot? Its plan
/// could not help it.
bool Coordinator::touches_somebody(const VehicleState& v) {
  constexpr double kLongest = 30.0;  // [m] of a road vehicle
  const Vehicle& body = type_of(v.type).body;
  const OrientedBox box = footprint(body, v.pose);
  const auto is_in_it = [&](const Pedestrian& p) { return separation(box, p.position) < p.radius; };
  if (std::ranges::any_of(traffic_.pedestrians(), is_in_it)) return true;
  return std::ranges::any_of(traffic_.vehicles(), [&](const VehicleState& other) {
    if (&other == &v || distance(v.pose, other.pose) > body.length() + kLongest) return false;
    return separation(box, footprint(type_of(other.type).body, other.pose)) < -Audit::kTolerance;
  });
}

/// Has it stood for so long that nothing about it changes by itself?
bool Coordinator::stands_for_good(const std::string& id) const {
  constexpr double kLong = 5.0;  // [s]
  const auto trail = trails_.find(id);
  return trail != trails_.end() && trail->second.stood * grid_.decision() > kLong;
}

/// Is it, or its tail, still in a turn behind it? Then it is taken over later, if there is room to
/// stop.
bool Coordinator::turns_yet(const Newcomer& newcomer) {
  const VehicleState& v = *newcomer.state;
  if (!can_wait(v.speed, type_of(v.type).body, newcomer.to_line)) return false;
  const Corridor& corridor = corridors_[newcomer.corridor];
  const double s = corridor.lines.front() - newcomer.to_line;
  return s < corridor.s_drivable || approach_to(corridor, v, s).is_aslant();
}

}  // namespace mvtp
