#include "coordinator/signals/green_lanes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <ranges>

#include "coordinator/corridor/no_waiting.hpp"
#include "planner/road.hpp"

namespace mvtp {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLeast = 60.0;     ///< [s] that the program is looked ahead, at least,
constexpr double kRound = 30.0;     ///< [s] to a multiple of this: so plans stay valid for a while
constexpr double kClearance = 2.5;  ///< [s] behind a yellow until the junction is clear
constexpr double kLine = 1.0;       ///< [m] that count as the line
constexpr double kWaits = 3.0;      ///< [s] for which a vehicle stays before its line: it waits
constexpr double kSlow = 3.0;       ///< [m/s], and does not drive faster
constexpr double kStands = 0.1;     ///< [m/s]
constexpr double kRounding = 0.05;  ///< [m] of where vehicles wait
constexpr double kBrakes = 0.8;     ///< share of its deceleration with which a driver stops for red
constexpr double kReaction = 0.5;   ///< [s]

/// The least time in which a driver covers a distance [s].
double least_time(double distance, double v, double accel, double limit) {
  if (v >= limit) return distance / v;
  const double speeding_up = (limit * limit - v * v) / (2.0 * accel);
  if (speeding_up >= distance) return (std::sqrt(v * v + 2.0 * accel * distance) - v) / accel;
  return (limit - v) / accel + (distance - speeding_up) / limit;
}

/// Does it let one go, after others?
bool is_permissive(char light) { return !is_protected(light) && !is_red(light) && light != 'y'; }

}  // namespace

GreenLanes::GreenLanes(Traffic& traffic, const LaneGraph& graph, const CourseFinder& finder,
                       CorridorMap& corridors, Predictor& predictor, const DecisionGrid& grid,
                       GreenGround ground, OverLine over_line)
    : traffic_(traffic),
      graph_(graph),
      finder_(finder),
      corridors_(corridors),
      predictor_(predictor),
      grid_(grid),
      ground_(ground),
      over_line_(std::move(over_line)) {
  for (int k = 0; k < graph.links(); ++k) {
    const LaneGraph::Link& link = graph.link(k);
    if (link.signal.empty() || !finder.is_coordinated(link.junction)) continue;
    if (traffic.signal_phases(link.signal).empty()) continue;
    if (!programs_.contains(link.signal)) {
      programs_.emplace(link.signal, SignalProgram(traffic, link.signal));
    }
    at_junction_[link.junction].push_back(k);
  }
}

void GreenLanes::observe() {
  for (auto& [id, program] : programs_) program.observe();
}

void GreenLanes::begin(std::int64_t step) {
  step_ = step;
  sensed_.clear();
  earliest_.clear();
  waiting_inside_.clear();
}

const SignalProgram* GreenLanes::program_of(int link) const {
  if (link == LaneGraph::kNone || !finder_.is_coordinated(graph_.link(link).junction)) {
    return nullptr;
  }
  const auto program = programs_.find(graph_.link(link).signal);
  return program == programs_.end() ? nullptr : &program->second;
}

/// The connection that a vehicle is on, or that leads from its lane along its route.
int GreenLanes::link_of(const CourseQuery& query) const {
  if (graph_.edge_of(query.lane) == LaneGraph::kNone) {
    const std::span<const int> over = graph_.links_over(query.lane);
    return over.empty() ? LaneGraph::kNone : over.front();
  }
  if (query.edges.size() < 2) return LaneGraph::kNone;
  const std::span<const int> links = graph_.links_from(query.lane);
  const auto link = std::ranges::find_if(
      links, [&](int k) { return graph_.edge_of(graph_.link(k).to) == query.edges[1]; });
  return link == links.end() ? LaneGraph::kNone : *link;
}

bool GreenLanes::governs(const CourseQuery& query) const {
  if (graph_.edge_of(query.lane) == LaneGraph::kNone) {
    return program_of(link_of(query)) != nullptr;
  }
  for (const int edge : query.edges) {
    const int junction = graph_.junction_behind(edge);
    if (junction == LaneGraph::kNone) return false;
    if (finder_.is_coordinated(junction)) return at_junction_.contains(junction);
  }
  return false;
}

/// Has he room to stop at the end of his lane?
bool GreenLanes::can_stop(const VehicleState& v, const CourseQuery& query,
                          const VehicleType& type) const {
  const double to_end = graph_.lane(query.lane).length - query.position;
  const double needed =
      stopping_distance(v.speed, kBrakes * type.body.max_decel) + kReaction * v.speed;
  return needed < to_end || v.speed < kStands;
}

/// Drivers with permissive green wait inside, at the end of the first of two internal lanes; and
/// whoever stands inside waits for somebody.
bool GreenLanes::may_wait_inside(const VehicleState& v, const CourseQuery& query,
                                 const VehicleType& type) const {
  const int link = link_of(query);
  const SignalProgram* program = program_of(link);
  if (program == nullptr || graph_.edge_of(query.lane) != LaneGraph::kNone) return false;
  if (v.speed < kStands) return true;
  const LaneGraph::Link& connection = graph_.link(link);
  return connection.via.size() > 1 && query.lane == connection.via.front() &&
         can_stop(v, query, type) && is_permissive(program->light_now(connection.signal_index));
}

void GreenLanes::sense_inside(const VehicleState& v, const CourseQuery& query,
                              const VehicleType& type) {
  if (may_wait_inside(v, query, type)) waiting_inside_.insert(link_of(query));
}

/// With protected green he goes; with permissive green he is expected to wait for others as long as
/// he can; otherwise he stops if he can.
std::vector<Forecast> GreenLanes::expect(const VehicleState& v, const CourseQuery& query,
                                         const VehicleType& type, std::int64_t step) {
  const auto predict = [&](Intent intent) {
    return predictor_.predict(v, query, type.body, intent, {}, grid_, step);
  };
  const int link = link_of(query);
  const SignalProgram* program = program_of(link);
  if (program == nullptr) return predict(Intent::kWaits);  // another line comes later
  if (graph_.edge_of(query.lane) != LaneGraph::kNone) {
    const bool goes = is_protected(program->light_now(graph_.link(link).signal_index));
    return predict(goes || !can_stop(v, query, type) ? Intent::kPasses : Intent::kWaits);
  }
  const std::optional<Predictor::Placed> placed =
      may_wait_inside(v, query, type) ? predictor_.place(v, query, type.body) : std::nullopt;
  if (!placed) return predict(Intent::kPasses);
  const double to_end = graph_.lane(query.lane).length - query.position;
  const double room = v.speed < kStands ? 0.0 : to_end;
  return {waits_at(placed->road, placed->road.now.s + room, step)};
}

/// One who stops there, until those across his path have passed.
Forecast GreenLanes::waits_at(const RoadVehicle& road, double stop, std::int64_t step) const {
  Forecast forecast{
      .vehicle = road, .earliest = predict_leader(road, {}, grid_, step), .latest = std::nullopt};
  SpeedProfile held = predict_leader(road, {StopLine{stop}}, grid_, step);
  const auto rest = std::ranges::find(held.states, 0.0, &InertialState::v);
  if (rest == held.states.end()) return forecast;
  held.states.erase(rest + 1, held.states.end());
  held.complete = false;
  forecast.held = std::move(held);
  return forecast;
}

void GreenLanes::sense(const VehicleState& v, int edge, int lane, double to_line,
                       const VehicleType& type) {
  types_.try_emplace(type.id, type);
  if (to_line > kSensors) return;
  const double limit = v.speed_factor * graph_.lane(graph_.lanes_of(edge).front()).speed_limit;
  const double wanted = std::max(1.0, std::min({limit, type.body.max_speed, v.top_speed}));
  const Sensed driver{v.id, to_line, least_time(to_line, v.speed, type.body.max_accel, wanted)};
  for (const int other : graph_.lanes_of(edge)) {
    if (lane == LaneGraph::kNone || lane == other) sensed_[other].push_back(driver);
  }
}

/// When the first human driver may be at the end of a lane [s], behind whom he follows; nullopt if
/// none is seen.
std::optional<double> GreenLanes::find_earliest(int lane) const {
  const auto drivers = sensed_.find(lane);
  if (drivers == sensed_.end()) return std::nullopt;
  std::vector<std::pair<double, double>> ahead;  // [m] to the line, [s] until they are over it
  for (const VehicleState& v : traffic_.vehicles()) {
    if (graph_.find_lane(v.lane) != lane) continue;
    const std::optional<double> over = over_line_(v.id);
    if (over) ahead.emplace_back(graph_.lane(lane).length - v.lane_position, *over);
  }
  double earliest = kInfinity;
  for (const Sensed& driver : drivers->second) {
    double there = driver.earliest;
    for (const auto& [to_line, over] : ahead) {
      if (to_line < driver.to_line) there = std::max(there, over);
    }
    earliest = std::min(earliest, there);
  }
  return earliest == kInfinity ? std::nullopt : std::optional(earliest);
}

std::optional<double> GreenLanes::earliest_on(int lane) {
  const auto [known, is_new] = earliest_.try_emplace(lane);
  if (is_new) known->second = find_earliest(lane);
  return known->second;
}

bool GreenLanes::follows_somebody(int lane, double to_line) const {
  const auto drivers = sensed_.find(lane);
  return drivers != sensed_.end() &&
         std::ranges::any_of(drivers->second, [&](const Sensed& d) { return d.to_line < to_line; });
}

/// The connections with a light on a corridor.
std::vector<GreenLanes::Crossing> GreenLanes::crossings_on(const Corridor& corridor) const {
  std::vector<Crossing> crossings;
  const std::vector<CorridorPiece>& pieces = corridor.course.pieces;
  for (std::size_t i = 0; i < corridor.course.lines.size(); ++i) {
    const auto line = std::size_t(corridor.course.lines[i]);
    if (line + 1 >= pieces.size()) continue;
    for (const int k : graph_.links_from(pieces[line].last_lane())) {
      const LaneGraph::Link& link = graph_.link(k);
      const int next = link.via.empty() ? link.to : link.via.front();
      if (next == pieces[line + 1].lane && program_of(k) != nullptr) {
        crossings.push_back({k, corridor.stops[i]});
      }
    }
  }
  return crossings;
}

/// Who cannot stop any more before its line goes on: the ground behind was open when it was
/// decided.
void GreenLanes::close(RoadVehicle& vehicle, int corridor, const VehicleType& type) {
  types_.try_emplace(type.id, type);
  vehicle.closed.clear();
  const Corridor& c = corridors_[corridor];
  const double rest = vehicle.now.s + stopping_distance(vehicle.now.v, type.body.max_decel);
  for (const Crossing& crossing : crossings_on(c)) {
    const std::size_t before = vehicle.closed.size();
    const LaneGraph::Link& own = graph_.link(crossing.link);
    for (const int other : at_junction_.at(own.junction)) {
      if (graph_.link(other).from != own.from) close_for(crossing, other, vehicle);
    }
    const auto here = std::ranges::subrange(vehicle.closed.begin() + std::ptrdiff_t(before),
                                            vehicle.closed.end());
    const bool is_beyond = rest > crossing.stop + kRounding + kLine;
    if (is_beyond) vehicle.closed.erase(here.begin(), here.end());
    if (!is_beyond) {
      vehicle.asks_again |= follows_somebody(own.from, crossing.stop - vehicle.now.s);
    }
  }
  vehicle.asks_again |= !vehicle.closed.empty();
  if (!vehicle.closed.empty() && vehicle.no_waiting.empty()) {
    vehicle.no_waiting = inside_junctions(c, type.body.length(), 0.0);
  }
}

/// Closes the ground that a vehicle shares with another connection while that one's drivers may be
/// on it.
void GreenLanes::close_for(const Crossing& crossing, int other, RoadVehicle& vehicle) {
  const auto [from, to] = common_ground(vehicle.path, other);
  if (from > to || vehicle.now.s > to) return;
  const SignalProgram& program = *program_of(crossing.link);
  const SignalProgram& theirs = *program_of(other);
  if (&program != &theirs) return;
  const double stop = crossing.stop + kRounding;
  const int own_index = graph_.link(crossing.link).signal_index;
  const int other_index = graph_.link(other).signal_index;
  const std::optional<double> first = earliest_on(graph_.link(other).from);
  const double time = traffic_.time();
  const double horizon = std::ceil((time + kLeast) / kRound) * kRound - time;
  const auto add = [&](double s, double s_end, double begin, double end) {
    end = std::min(end, horizon);
    if (begin >= end) return;
    vehicle.closed.push_back({s, s_end, step_ + std::int64_t(std::floor(begin / grid_.dt)),
                              step_ + std::int64_t(std::ceil(end / grid_.dt))});
  };
  // Who waits inside with a green that yields does so for those with a better one only.
  const bool waits = waiting_inside_.contains(other);
  const bool is_left_over = !is_permissive(program.light_now(other_index));
  for (const SignalProgram::Course& course : program.courses(horizon)) {
    for (std::size_t i = 0; i < course.size(); ++i) {
      const SignalProgram::Shown& shown = course[i];
      const char right = program.right(shown.phase, own_index);
      if (waits && (!is_protected(right) || is_left_over)) add(from, to, shown.begin, shown.end);
      if (is_protected(right)) continue;
      if (is_red(program.light(shown.phase, other_index))) continue;
      const bool only_sensed = ground_ == GreenGround::kSensed || !is_red(right);
      if (only_sensed && !first) continue;
      const bool goes_next =
          i + 1 < course.size() && !is_red(program.light(course[i + 1].phase, own_index));
      const bool ends = i + 1 < course.size() &&
                        is_red(program.light(course[i + 1].phase, other_index)) && !goes_next;
      const double begin = std::max(shown.begin, only_sensed ? *first : 0.0);
      const double end = shown.end + (ends ? kClearance : 0.0);
      // Who has come over the line before it was red may clear the junction.
      const bool turned_red =
          i > 0 && is_red(right) && !is_red(program.right(course[i - 1].phase, own_index));
      const double clear = turned_red ? std::max(begin, shown.begin + kClearance) : begin;
      if (clear > begin) add(stop, std::min(stop + kLine, from), begin, std::min(clear, end));
      add(from, to, clear, end);
    }
  }
}

/// The part of a path [m] on tiles that bodies touch who go over a connection; empty: from > to.
std::pair<double, double> GreenLanes::common_ground(int path, int link) {
  std::pair<double, double> ground{kInfinity, -kInfinity};
  for (const auto& [id, type] : types_) {
    const auto [known, is_new] = grounds_.try_emplace({path, link, id}, kInfinity, -kInfinity);
    if (is_new) {
      const int other = path_over(link, type);
      const std::array<int, 2> both = {path, other};
      corridors_.library().build_tables(both);
      const ContactTable& tiles = corridors_.library().reserved(path, other);
      if (!tiles.empty()) known->second = {tiles.first(), tiles.last()};
    }
    ground.first = std::min(ground.first, known->second.first);
    ground.second = std::max(ground.second, known->second.second);
  }
  return ground;
}

/// The path of a body from the lane to the lane of a connection.
int GreenLanes::path_over(int link, const VehicleType& type) {
  constexpr double kBefore = 30.0;  // [m] before the line where the path begins
  const LaneGraph::Link& connection = graph_.link(link);
  const std::array<int, 2> edges = {graph_.edge_of(connection.from), graph_.edge_of(connection.to)};
  const CourseQuery query{.lane = connection.from,
                          .position = std::max(0.0, graph_.lane(connection.from).length - kBefore),
                          .edges = edges,
                          .length = type.body.length()};
  const std::optional<CorridorCourse> course = finder_.find(query);
  const int corridor =
      corridors_.corridor_for(course ? *course : finder_.follow(query, kBefore), type.body);
  return corridors_[corridor].path;
}

/// Vehicles under control from other lanes that stay before their lines for now.
std::vector<std::string> GreenLanes::who_waits_for(const VehicleState& driver) const {
  std::vector<std::string> ids;
  for (const VehicleState& v : traffic_.vehicles()) {
    if (v.lane == driver.lane || distance(v.pose, driver.pose) > kSensors / 2.0) continue;
    const std::optional<double> over = over_line_(v.id);
    if (over && *over > kWaits && v.speed < kSlow) ids.push_back(v.id);
  }
  return ids;
}

void GreenLanes::settle() {
  std::map<std::string, std::vector<std::string>> relying;
  for (const VehicleState& v : traffic_.vehicles()) {
    if (traffic_.is_taken_over(v.id)) continue;
    const int lane = graph_.find_lane(v.lane);
    if (lane == LaneGraph::kNone) continue;
    const bool inside = graph_.edge_of(lane) == LaneGraph::kNone;
    const std::span<const int> links = inside ? graph_.links_over(lane) : graph_.links_from(lane);
    const bool has_light =
        std::ranges::any_of(links, [&](int k) { return program_of(k) != nullptr; });
    if (!has_light) continue;
    if (std::vector<std::string> waiting = who_waits_for(v); !waiting.empty()) {
      relying.emplace(v.id, std::move(waiting));
    }
  }
  for (const auto& [id, waiting] : relying_) {
    if (!relying.contains(id)) traffic_.rely_on_signal(id, {});
  }
  for (const auto& [id, waiting] : relying) {
    const auto before = relying_.find(id);
    if (before == relying_.end() || before->second != waiting) {
      traffic_.rely_on_signal(id, waiting);
    }
  }
  relying_ = std::move(relying);
}

}  // namespace mvtp
