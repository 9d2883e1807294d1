// How a vehicle that comes under control is seen by the planner.

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "coordinator/corridor/no_waiting.hpp"
#include "coordinator/junctions/coordinator.hpp"

namespace mvtp {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kBeforeCrossing = 0.4;  ///< [m] before a line are left to people, long turns
constexpr double kLeastShare = 0.5;      ///< of its acceleration, however it comes onto its path
constexpr double kWholeShare = 0.99;     ///< from here on it uses all of it
constexpr double kShareStep = 0.05;      ///< vehicles of about the same share use one corridor

/// Behind a line nobody without a complete plan creeps on, onto a crossing where people wait for
/// it to leave: a line at every place there.
std::vector<double> lines_beside_people(const std::vector<double>& stops) {
  constexpr double kInside = 15.0;  // [m] of junction
  std::vector<double> lines;
  for (const double stop : stops) {
    for (double s = stop - kBeforeCrossing; s < stop + kInside; s += ReferencePath::kSpacing) {
      if (lines.empty() || s > lines.back()) lines.push_back(s);
    }
  }
  return lines;
}

/// The lanes before the first line on which it is a leader of those who leave another junction.
std::vector<EntryLane> entry_lanes(const Corridor& corridor, const Predictor& predictor,
                                   double length) {
  std::vector<EntryLane> lanes;
  const auto last = std::size_t(corridor.course.lines.front());
  const auto enter = [&](int lane, std::size_t piece, double from) {
    const ExitRoot root = predictor.exit_root(lane);
    if (!lanes.empty() && lanes.back().lane == root.lane) return;
    if (!lanes.empty()) lanes.back().to = from + length;
    if (root.lane == LaneGraph::kNone) return;
    lanes.push_back({root.lane, corridor.stations[piece] - root.offset, from});
  };
  for (std::size_t i = 0; i <= last; ++i) {
    const CorridorPiece& piece = corridor.course.pieces[i];
    // Inside a junction without conflicts it is a leader still.
    if (i > 0 && predictor.exit_root(piece.lane).lane == LaneGraph::kNone) continue;
    enter(piece.lane, i, i == 0 ? -kInfinity : corridor.stations[i]);
    if (piece.target == LaneGraph::kNone) continue;
    enter(piece.target, i, corridor.stations[i] + piece.begin * corridor.scales[i]);
  }
  if (!lanes.empty()) {
    lanes.back().to = std::min(lanes.back().to, corridor.stops.front() + length);
  }
  return lanes;
}

}  // namespace

/// From where a vehicle is onto the path of a corridor, about `station` along it.
PathApproach Coordinator::approach_to(const Corridor& corridor, const VehicleState& v,
                                      double station) const {
  constexpr double kNear = 3.0;  // [m]
  const ReferencePath& path = corridors_.library().path(corridor.path);
  return {path, v.pose, path.project({v.pose.x, v.pose.y}, station - kNear, station + kNear)};
}

/// Has it been turned away for long?
bool Coordinator::is_impatient(const std::string& id) const {
  const auto times = turned_away_.find(id);
  return times != turned_away_.end() && times->second * grid_.decision() > kStuckAfter;
}

/// Beside its path a vehicle drives a little faster or slower than along it: the same corridor for
/// a body that accelerates as much less.
int Coordinator::corridor_beside(int number, const PathApproach& approach, const VehicleState& v) {
  const Corridor& along = corridors_[number];
  Vehicle body = type_of(v.type).body;
  const double left =
      approach.acceleration_share(corridors_.library().path(along.path), v.speed,
                                  std::min(body.max_accel, body.max_decel), along.lateral_limits);
  if (left >= kWholeShare) return number;
  const double share = std::max(std::floor(left / kShareStep) * kShareStep, kLeastShare);
  body.max_accel *= share;
  body.max_decel *= share;
  return corridors_.corridor_for(along.course, body);
}

Driven Coordinator::admit(const Newcomer& newcomer, std::int64_t key) {
  const VehicleState& v = *newcomer.state;
  const VehicleType& type = type_of(v.type);
  Driven driven{.key = key, .corridor = newcomer.corridor, .route = newcomer.route};
  const double expected = corridors_[newcomer.corridor].lines.front() - newcomer.to_line;
  driven.approach = approach_to(corridors_[driven.corridor], v, expected);
  // Plans know no more of it than its path: half of what is kept off others at the sides counts.
  constexpr double kBeside = 0.1;  // [m]
  if (driven.approach.aside() > kBeside) {
    driven.corridor = corridors_.joined(driven.corridor, driven.approach);
    driven.approach = approach_to(corridors_[driven.corridor], v, expected);
  } else {
    driven.corridor = corridor_beside(driven.corridor, driven.approach, v);
  }
  const Corridor& c = corridors_[driven.corridor];

  const double top_speed = std::min(type.body.max_speed, v.top_speed);
  std::vector<double> limits = c.lateral_limits;
  for (std::size_t i = 0; i < limits.size(); ++i) {
    limits[i] = std::min({limits[i], v.speed_factor * c.lane_limits[i], top_speed});
  }
  RoadVehicle& road = driven.road;
  road.key = driven.key;
  road.stuck = v.speed == 0.0 && is_impatient(v.id);
  road.path = c.path;
  road.now = {driven.approach.begin(), v.speed * c.ratios[c.piece_at(expected)]};
  driven.since = step_;
  delay(driven, v);
  road.cruise_speed = std::min(v.speed_factor * c.lane_limits.back(), top_speed);
  road.envelope =
      std::make_shared<SpeedEnvelope>(std::move(limits), comfortable_braking(type.body));
  road.weight = options_.priority.weight_of(type);
  road.min_gap = type.min_gap;
  road.tau = type.tau;
  road.stop_lines = people_ ? lines_beside_people(c.stops) : c.stops;
  // Who reserves ground waits at the line, as published.
  const bool reserves = options_.limits.reservation != Reservation::kNone;
  if (heads_ || !reserves) {
    road.no_waiting = inside_junctions(c, type.body.length(), kBeforeCrossing);
  }
  if (!heads_ && !reserves) road.run_ups = run_ups(c, type.body.length());
  road.between = lanes_between(graph_, c);
  road.asks_again = humans_ != nullptr;  // the further they are, the less is uncertain of drivers
  road.entry_lanes = entry_lanes(c, predictor_, type.body.length());
  road.exit_lane = c.exit_lane;
  road.s_exit_lane = c.s_exit;
  road.s_handback = c.s_handback;
  road.s_end = c.s_end;
  return driven;
}

}  // namespace mvtp
