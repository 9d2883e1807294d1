#include "coordinator/prediction/prediction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "coordinator/prediction/tube.hpp"

namespace mvtp {
namespace {

constexpr double kHold = 3.0;           ///< [s] for which a driver keeps his speed
constexpr double kAcceleration = 1.0;   ///< [m/s^2] after that
constexpr double kHesitant = 0.5;       ///< share of his acceleration that one let through takes,
constexpr double kEasing = 1.0;         ///< [m/s^2] who takes his time, or slows down
constexpr double kCrawl = 4.0;          ///< [m/s] to no less than this
constexpr double kQuickShare = 1.01;    ///< of the speed that he wants,
constexpr double kSlowShare = 0.9;      ///< and of one who takes his time,
constexpr double kSlowBraking = 0.6;    ///< with this share of his deceleration
constexpr double kAheadOfTime = 1.0;    ///< [s] that a driver who is held may be ahead of that
constexpr double kStand = 60.0;         ///< [s] that he stands there
constexpr std::size_t kLongest = 3000;  ///< steps that are predicted

/// The acceleration of a driver who would take `a` but is to stop before a line [m/s^2].
double before_line(const InertialState& now, double a, const StopLine& line, double dt) {
  constexpr double kHardest = 4.5;  // [m/s^2] as hard as drivers brake if they have to
  constexpr double kShort = 1.0;    // [m] before the line
  constexpr double kRolls = 1e-3;   // [m/s]: who is slower stands
  const auto stays_short = [&](double acceleration) {
    const InertialState next = advance(now, acceleration, dt);
    return next.s + stopping_distance(next.v, line.braking) <= line.s - kShort;
  };
  if (stays_short(a)) return a;
  if (now.v > kRolls && stays_short(0.0)) return 0.0;
  const double room = line.s - now.s;
  const auto needed = [&](double within) {
    return within > 0.0 ? now.v * now.v / (2.0 * within) : now.v / dt;
  };
  // SUMO drives a whole step at the speed that it has at the step's end: braking takes it less far.
  const double less = now.v * dt / 2.0;
  if (needed(room + less) > line.hardest) return -line.braking;
  // Whoever brakes late stands as far from it as others, if he can.
  const bool stands_short =
      room > kShort && needed(room - kShort + less) <= std::min(kHardest, line.hardest);
  const double braking = std::max(line.braking, needed(stands_short ? room - kShort : room));
  return -std::min(braking, now.v / dt);
}

/// Appends states until the end of the path, each with the acceleration that `wish` asks for, with
/// a stand at each of the `lines`.
template <class Wish>
void drive_on(SpeedProfile& t, const RoadVehicle& v, const DecisionGrid& grid,
              const std::vector<StopLine>& lines, const Wish& wish) {
  std::vector<double> stood(lines.size(), 0.0);
  while (t.states.back().s < v.s_end && t.states.size() < kLongest) {
    const InertialState last = t.states.back();
    const double time = double(t.states.size() - 1) * grid.dt;
    double a = wish(last);
    std::size_t at = lines.size();  // the line that holds him
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (time >= lines[i].until || stood[i] >= kStand) continue;
      const double braking = before_line(last, a, lines[i], grid.dt);
      if (braking < a) at = i;
      a = std::min(a, braking);
    }
    t.states.push_back(advance(last, a, grid.dt));
    if (at < lines.size() && t.states.back().v == 0.0) stood[at] += grid.dt;
  }
}

/// Held speed until step `hold`, then gentle acceleration.
void drive_on(SpeedProfile& t, const RoadVehicle& v, const DecisionGrid& grid, std::size_t hold,
              const std::vector<StopLine>& lines = {}) {
  drive_on(t, v, grid, lines, [&](const InertialState& last) {
    const bool holds = t.states.size() <= hold || last.v >= v.cruise_speed;
    return holds ? 0.0 : kAcceleration;
  });
}

/// What it does until it stands at its line, and there it stays; nullopt if it does not stand
/// there.
std::optional<SpeedProfile> held_at_line(const SpeedProfile& t, const DecisionGrid& grid) {
  const auto stand = std::ptrdiff_t(0.9 * kStand / grid.dt);
  const auto rest = std::ranges::search_n(t.states, stand, 0.0, {}, &InertialState::v);
  if (rest.empty()) return std::nullopt;
  return SpeedProfile{t.begin, {t.states.begin(), rest.begin() + 1}, /*complete=*/false};
}

constexpr double kNearEnd = 60.0;     ///< [m] before the end of its corridor it needs a longer path
constexpr double kHorizon = 40.0;     ///< [m] behind its line for which a vehicle is predicted
constexpr double kRest = 1.0;         ///< [m] of path that there is at least ahead of it
constexpr double kAlongside = 40.0;   ///< [m] behind the place of the takeover
constexpr double kExitRange = 250.0;  ///< [m] behind a junction in which leaders matter

}  // namespace

Predictor::Predictor(const LaneGraph& graph, const CourseFinder& finder, CorridorMap& corridors)
    : graph_(graph), finder_(finder), corridors_(corridors), watched_(graph, finder) {
  for (int l = 0; l < graph.lanes(); ++l) exit_roots_.push_back(find_exit_root(l, kExitRange));
}

ExitRoot Predictor::find_exit_root(int lane, double within) const {
  const std::span<const int> links = graph_.links_to(lane);
  for (const int k : links) {
    if (finder_.is_coordinated(graph_.link(k).junction)) return {lane, 0.0};
  }
  for (const int k : links) {
    const LaneGraph::Link& link = graph_.link(k);
    const double length = std::max(1.0, link.length + graph_.lane(link.from).length);
    if (length >= within) continue;
    const ExitRoot root = find_exit_root(link.from, within - length);
    if (root.lane != LaneGraph::kNone) return {root.lane, root.offset + length};
  }
  return {};
}

/// Does a corridor lead on from the lane of the query onto the next edge, and the next lane, of its
/// driver?
bool Predictor::leads_where_it_goes(const Corridor& corridor, const CourseQuery& query) const {
  const auto& pieces = corridor.course.pieces;
  const auto here = std::ranges::find(pieces, query.lane, &CorridorPiece::last_lane);
  const auto is_normal = [&](const CorridorPiece& p) {
    return graph_.edge_of(p.lane) != LaneGraph::kNone;
  };
  if (here == pieces.end() || query.edges.size() < 2) return true;
  const auto next = std::find_if(here + 1, pieces.end(), is_normal);
  if (next == pieces.end()) return true;
  if (query.next_lane != LaneGraph::kNone) return next->lane == query.next_lane;
  return graph_.edge_of(next->lane) == query.edges[1];
}

void Predictor::corridors_forgotten() {
  std::erase_if(expected_on_,
                [&](const auto& entry) { return !corridors_.holds(entry.second.corridor); });
}

/// The corridor that the vehicle follows, and where on it its rear axle is.
int Predictor::path_of(const VehicleState& v, const CourseQuery& query, const Vehicle& body,
                       double& station) {
  const auto place_on = [&](const Corridor& corridor, double expected, double room) {
    const std::optional<double> s = corridor.station(query.lane, query.position, expected);
    if (!s) return false;
    const ReferencePath& path = corridors_.library().path(corridor.path);
    station = path.project({v.pose.x, v.pose.y}, *s - 3.0, *s + 3.0);
    return station < path.length() - room;
  };
  if (const auto known = expected_on_.find(v.id); known != expected_on_.end()) {
    const auto [number, s] = known->second;
    const Corridor& corridor = corridors_[number];
    if (leads_where_it_goes(corridor, query) && place_on(corridor, s, kNearEnd)) {
      corridors_.use(number);
      known->second.s = station;
      return number;
    }
    expected_on_.erase(known);
  }
  const int own =
      corridors_.corridor_for(finder_.follow(query, finder_.furthest_takeover() + kHorizon), body);
  const Corridor& corridor = corridors_[own];
  if (place_on(corridor, corridor.stations.front(), kRest)) return own;
  if (!corridor.course.dead_end) return LaneGraph::kNone;
  station = corridors_.library().path(corridor.path).length() - kRest;  // it waits at the very end
  return own;
}

std::optional<Predictor::Placed> Predictor::place(const VehicleState& v, const CourseQuery& query,
                                                  const Vehicle& body) {
  double s = 0.0;
  const int number = path_of(v, query, body, s);
  if (number == LaneGraph::kNone) return std::nullopt;
  const Corridor& corridor = corridors_[number];
  RoadVehicle road;
  road.key = -1;
  road.path = corridor.path;
  road.now = {s, v.speed};
  road.stuck = v.speed == 0.0;
  road.cruise_speed = std::max(
      1.0, std::min({v.speed_factor * corridor.lane_limits.back(), body.max_speed, v.top_speed}));
  const ExitRoot root = exit_roots_[std::size_t(query.lane)];
  if (root.lane != LaneGraph::kNone) {
    road.exit_lane = root.lane;
    road.s_exit_lane =
        corridor.station(query.lane, 0.0, s - query.position).value_or(s) - root.offset;
  }
  road.s_end = corridors_.library().path(corridor.path).length();
  road.s_handback = road.s_end;
  return Placed{number, road};
}

std::shared_ptr<const SpeedEnvelope> Predictor::envelope_of(const Placed& placed, double share,
                                                            double braking) const {
  return std::make_shared<SpeedEnvelope>(
      drivers_envelope(corridors_[placed.corridor].lane_limits, share, braking));
}

std::optional<StopLine> Predictor::lane_end(const Placed& placed) const {
  const Corridor& corridor = corridors_[placed.corridor];
  if (!corridor.course.dead_end) return std::nullopt;
  const double length = graph_.lane(corridor.course.pieces.back().lane).length;
  // The path is made of pieces of a given length, and may end a little before the lane does.
  const double end = corridors_.library().path(corridor.path).length() - kRest / 2.0;
  return StopLine{std::min(end, corridor.stations.back() + corridor.ratios.back() * length),
                  std::numeric_limits<double>::infinity()};  // his lane does not lead on
}

/// Where the rear axle is when it waits behind those who stand ahead.
std::optional<StopLine> Predictor::behind_queue(const Placed& placed,
                                                const CourseQuery& query) const {
  constexpr double kGap = 1.0;  // [m] at least
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Corridor& corridor = corridors_[placed.corridor];
  const auto& pieces = corridor.course.pieces;
  for (std::size_t p = corridor.piece_at(placed.road.now.s); p < pieces.size(); ++p) {
    const int lane = pieces[p].last_lane();
    const double from = lane == query.lane ? query.position : -kInfinity;
    const HaltedDriver* ahead = queues_.first_ahead(lane, from);
    if (ahead == nullptr) continue;
    const auto s = corridor.station(lane, ahead->tail - kGap, corridor.stations[p]);
    return s ? std::optional(StopLine{*s, kInfinity, ahead->stands}) : std::nullopt;
  }
  return std::nullopt;
}

std::vector<StopLine> Predictor::lines_ahead(const Placed& placed, const CourseQuery& query,
                                             const Stand& stand,
                                             const std::optional<StopLine>& own) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<StopLine> lines;
  if (stand.behind) {
    const double s = placed.road.now.s + *stand.behind - query.position;
    lines.push_back({.s = s, .hardest = kInfinity});
  }
  for (const auto& line : {own, behind_queue(placed, query)}) {
    if (line) lines.push_back(*line);
  }
  return lines;
}

/// How quickly it goes nobody knows: it may speed up as it can and may, or slow down to a crawl,
/// and wait where its lane ends.
void Predictor::let_pass(Forecast& forecast, const Placed& placed, double speed_factor,
                         const Vehicle& body, const std::vector<StopLine>& lines,
                         const DecisionGrid& grid) const {
  RoadVehicle road = placed.road;
  road.envelope = envelope_of(placed, kQuickShare * speed_factor, body.max_decel);
  forecast.earliest = predict_passage(road, body, grid, forecast.earliest.begin);
  road.envelope = envelope_of(placed, kSlowShare * speed_factor, kSlowBraking * body.max_decel);
  forecast.latest = predict_crawl(road, body, lines, grid, forecast.earliest.begin);
  forecast.yields = false;
  forecast.relies = true;
}

std::vector<Forecast> Predictor::predict(const VehicleState& v, const CourseQuery& query,
                                         const Vehicle& body, Intent intent, const Stand& stand,
                                         const DecisionGrid& grid, std::int64_t step) {
  const ExitRoot root = exit_roots_[std::size_t(query.lane)];
  const std::optional<CourseFinder::LineAhead> line = finder_.line_ahead(query);
  const bool is_inside = graph_.edge_of(query.lane) == LaneGraph::kNone;
  // Whoever is further from the next line than those under control is not ahead of them there, but
  // may be in the lane beside them.
  const bool is_unknown = intent == Intent::kUnknown;
  const bool is_far = !is_unknown && line && line->distance > line->takeover + kAlongside;
  if (is_far && root.lane == LaneGraph::kNone && !is_inside) return {};
  std::optional<Placed> placed = place(v, query, body);
  if (!placed) return {};
  RoadVehicle& road = placed->road;
  const double s = road.now.s;
  Forecast forecast{.vehicle = road, .earliest = {.begin = step}, .latest = std::nullopt};
  if (stand.scheduled > 0.0) {
    forecast.earliest = predict_stop(road, stand.scheduled, grid, step);
    return {forecast};
  }
  if (is_unknown) {
    constexpr double kStanding = 0.1;  // [m/s]
    forecast.latest = predict_breakdown(road, body.max_decel, grid, step);
    forecast.earliest =
        v.speed < kStanding ? *forecast.latest : predict_passage(road, body, grid, step);
    if (v.speed < kStanding) forecast.latest.reset();
    forecast.yields = false;
    return {forecast};
  }
  const bool at_line = line && line->is_near() && s + line->distance < road.s_end;
  std::optional<StopLine> stop = lane_end(*placed);
  constexpr double kSame = 1.0;  // [m] between the end of a lane and the line there
  const bool ends_before_line = stop && at_line && stop->s < s + line->distance + kSame;
  if (intent == Intent::kPasses && !ends_before_line && (at_line || is_inside)) {
    let_pass(forecast, *placed, v.speed_factor, body, lines_ahead(*placed, query, stand, stop),
             grid);
    expected_on_[v.id] = {placed->corridor, s};
    return {forecast};
  }
  const bool is_held = at_line && !is_inside;
  if (line) {
    // It is held at the end of its lane, or driven as soon as it is nearer.
    const bool at_end = is_held && intent == Intent::kWaits;
    const double to_end = graph_.lane(query.lane).length - query.position;
    const double stands = s + (at_end ? std::min(line->distance, to_end) : line->distance);
    if (!stop || stands < stop->s - kSame) {
      stop = StopLine{.s = stands, .hardest = body.max_decel};
      if (is_held) stop->braking = body.max_decel;  // SUMO's drivers brake as late as they can
    }
  }
  forecast.earliest = predict_leader(road, lines_ahead(*placed, query, stand, stop), grid, step,
                                     at_line ? 0.0 : stand.so_far);
  forecast.yields = at_line || !comes_beside(*placed);
  if (!forecast.yields) hurry(forecast, *placed, v.speed_factor, body, grid);
  if (is_held) {
    forecast.held = held_at_line(forecast.earliest, grid);
    forecast.slack_before = int(std::lround(kAheadOfTime / grid.dt));
  }
  return {forecast};
}

/// He sees nobody for whom he would go slowly: he may speed up as he can and may.
void Predictor::hurry(Forecast& forecast, const Placed& placed, double speed_factor,
                      const Vehicle& body, const DecisionGrid& grid) const {
  RoadVehicle road = placed.road;
  road.envelope = envelope_of(placed, kQuickShare * speed_factor, body.max_decel);
  SpeedProfile earliest = predict_passage(road, body, grid, forecast.earliest.begin);
  for (std::size_t k = 0; k < forecast.earliest.states.size(); ++k) {
    InertialState& latest = forecast.earliest.states[k];
    latest.s = std::min(latest.s, earliest.at(earliest.begin + std::int64_t(k)).s);
  }
  forecast.latest = std::exchange(forecast.earliest, std::move(earliest));
}

/// Does it soon come near to a corridor where no connection says so?
bool Predictor::comes_beside(const Placed& placed) const {
  constexpr double kSoon = 60.0;  // [m]
  const Corridor& corridor = corridors_[placed.corridor];
  const double s = placed.road.now.s;
  for (std::size_t p = corridor.piece_at(s); p < corridor.stations.size(); ++p) {
    if (corridor.stations[p] > s + kSoon) return false;
    if (watched_.is_beside(corridor.course.pieces[p].last_lane())) return true;
  }
  return false;
}

SpeedProfile predict_leader(const RoadVehicle& v, const std::vector<StopLine>& lines,
                            const DecisionGrid& grid, std::int64_t step, double stood) {
  SpeedProfile t{.begin = step, .states = {v.now}};
  drive_on(t, v, grid, std::size_t(std::clamp(stood, kHold, kStand) / grid.dt), lines);
  return t;
}

SpeedProfile predict_stop(const RoadVehicle& v, double stands, const DecisionGrid& grid,
                          std::int64_t step) {
  SpeedProfile t{.begin = step, .states = {{v.now.s, 0.0}}};
  const double steps = std::min(stands / grid.dt, double(kLongest));
  t.states.resize(std::size_t(steps) + 1, t.states.front());
  drive_on(t, v, grid, 0);
  return t;
}

SpeedProfile predict_breakdown(const RoadVehicle& v, double decel, const DecisionGrid& grid,
                               std::int64_t step) {
  SpeedProfile t{.begin = step, .states = {v.now}};
  while (t.states.back().v > 0.0) t.states.push_back(advance(t.states.back(), -decel, grid.dt));
  t.states.resize(t.states.size() + std::size_t(kStand / grid.dt), t.states.back());
  drive_on(t, v, grid, 0);
  return t;
}

SpeedProfile predict_crawl(const RoadVehicle& v, const Vehicle& body,
                           const std::vector<StopLine>& lines, const DecisionGrid& grid,
                           std::int64_t step) {
  SpeedProfile t{.begin = step, .states = {v.now}};
  drive_on(t, v, grid, lines, [&](const InertialState& last) {
    const double wanted = (std::min(kCrawl, v.cruise_speed) - last.v) / grid.dt;
    const double a = std::clamp(wanted, -kEasing, kHesitant * body.max_accel);
    if (!v.envelope) return a;
    const double most = (v.envelope->at(last.s + last.v * grid.dt) - last.v) / grid.dt;
    return std::max(std::min(a, most), -body.max_decel);
  });
  return t;
}

SpeedProfile predict_passage(const RoadVehicle& v, const Vehicle& body, const DecisionGrid& grid,
                             std::int64_t step) {
  SpeedProfile t{.begin = step, .states = {v.now}};
  while (t.states.back().s < v.s_end && t.states.size() < kLongest) {
    const InertialState last = t.states.back();
    double speed = std::max(last.v, std::min(last.v + body.max_accel * grid.dt, v.cruise_speed));
    if (v.envelope) {
      const double most = v.envelope->at(last.s + speed * grid.dt);
      speed = std::clamp(most, last.v - body.max_decel * grid.dt, speed);
    }
    // SUMO drives a whole step at the speed that it has at the step's end (Euler).
    const double drives = speed < last.v ? 0.5 * (last.v + speed) : speed;
    t.states.push_back({last.s + drives * grid.dt, speed});
  }
  return t;
}

}  // namespace mvtp
