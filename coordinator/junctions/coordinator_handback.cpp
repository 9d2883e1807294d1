// Vehicles at the end of their corridors: which of them go on into the next corridor, and which are
// handed back to their drivers, and when.

#include <algorithm>

#include "coordinator/junctions/coordinator.hpp"

namespace mvtp {

/// Hands back those at the end of their corridor; but those with a stop line near are to go on into
/// the next corridor.
std::map<std::string, Driven> Coordinator::leave_corridors(bool may_go_on) {
  std::map<std::string, Driven> going_on;
  std::vector<std::string> finished;
  for (const auto& [id, driven] : driven_) {
    if (here(driven).s < driven.road.s_handback) {
      if (is_left_at_rest(driven) || is_wedged(id, driven)) finished.push_back(id);
      continue;
    }
    const bool inside = is_inside(driven);
    const std::optional<Newcomer> next =
        inside || planner_is_dead() ? std::nullopt : next_corridor(driven, believed(id, driven));
    if (!next) {
      const bool now = !inside && !leaves_lane(driven) && driver_has_room(id, driven) &&
                       nobody_comes_over(driven);
      if (now || ends_soon(driven)) finished.push_back(id);
    } else if (may_go_on) {
      Driven& arrival = going_on.emplace(id, admit(*next, driven.key)).first->second;
      // The traffic's speed is that along the lanes, which the two corridors may scale otherwise.
      arrival.road.now.v = driven.road.now.v;
      continue_on(arrival, driven);
    }
  }
  for (const std::string& id : finished) hand_back(id);
  return going_on;
}

/// Has it come to rest without a plan how to go on, and nobody makes another one?
bool Coordinator::is_left_at_rest(const Driven& driven) const {
  return planner_is_dead() && driven.road.now.v == 0.0 && !plan_.find(driven.key)->complete;
}

/// Has it stood for long with its body against another one, or somebody on foot, as where the
/// traffic let them depart beside it? Each may wait for the other; the traffic's drivers drive on.
bool Coordinator::is_wedged(const std::string& id, const Driven& driven) {
  return stands_for_good(id) && !is_inside(driven) && touches_somebody(*find_state(id));
}

/// Is its front inside a junction? Its driver would have to turn, and behind it it may go on into
/// the next corridor.
bool Coordinator::is_inside(const Driven& driven) const {
  const Corridor& corridor = corridors_[driven.corridor];
  const CorridorPiece& piece = corridor.course.pieces[corridor.piece_at(here(driven).s)];
  return graph_.edge_of(piece.lane) == LaneGraph::kNone;
}

/// Does it come onto another lane in the next step? SUMO gives a connection a length of 0.1 m at
/// least, also where its shape is a point: a vehicle that crosses it moves less than its speed
/// says.
bool Coordinator::leaves_lane(const Driven& driven) const {
  const Corridor& corridor = corridors_[driven.corridor];
  const InertialState now = here(driven);
  const double a = corridors_.library().body(driven.road.path).max_accel;
  const double then = now.s + (now.v + a * grid_.dt) * grid_.dt;
  return corridor.piece_at(then) != corridor.piece_at(now.s);
}

/// Is there no place left for a later hand-back?
bool Coordinator::ends_soon(const Driven& driven) const {
  const InertialState now = here(driven);
  return planner_is_dead() || now.s + now.v * grid_.dt >= corridors_[driven.corridor].s_latest;
}

/// Would its driver have his headway to the vehicle ahead? If not, the vehicle stays under control
/// for a while, and slows down as gently as its plan can.
bool Coordinator::driver_has_room(const std::string& id, const Driven& driven) {
  constexpr double kRange = 60.0;  // [m]
  const Corridor& corridor = corridors_[driven.corridor];
  const InertialState now = here(driven);
  const double b = corridors_.library().body(driven.road.path).max_decel;
  const Pose here = path_of(driven).at(now.s);
  return std::ranges::none_of(traffic_.vehicles(), [&](const VehicleState& v) {
    const int lane = graph_.find_lane(v.lane);
    if (v.id == id || lane == LaneGraph::kNone || distance(here, v.pose) > kRange) return false;
    const std::optional<double> s = corridor.station(lane, v.lane_position, now.s);
    if (!s || *s <= now.s) return false;
    const Vehicle& ahead = type_of(v.type).body;
    const double wanted = drivers_gap(driven.road, now.v, b, v.speed, ahead.max_decel);
    return *s - now.s - ahead.length() < wanted;
  });
}

/// Do all others under control keep off the ground on which the driver who gets it back would be,
/// whether he speeds up or not, and off the gap that he keeps? He makes no room for who comes over.
bool Coordinator::nobody_comes_over(const Driven& driven) const {
  constexpr double kRange = 60.0;     // [m]
  constexpr double kForesight = 4.0;  // [s]
  const InertialState now = here(driven);
  const Pose place = path_of(driven).at(now.s);
  const Corridor& corridor = corridors_[driven.corridor];
  const Vehicle& body = corridors_.library().body(driven.road.path);
  const double cruise = std::max(now.v, driven.road.cruise_speed);
  const auto steps = std::int64_t(kForesight / grid_.dt);
  return std::ranges::none_of(driven_, [&](const auto& entry) {
    const auto& [id, other] = entry;
    if (other.key == driven.key || other.corridor == driven.corridor) return false;
    const VehicleState& v = *find_state(id);
    if (distance(place, v.pose) > kRange) return false;
    // Who is ahead on its lane already is followed.
    const std::optional<double> s =
        corridor.station(graph_.find_lane(v.lane), v.lane_position, now.s);
    if (s && *s > now.s) return false;
    const ContactTable& contacts = corridors_.library().contacts(other.road.path, driven.road.path);
    const SpeedProfile& plan = *plan_.find(other.key);
    const double their_decel = corridors_.library().body(other.road.path).max_decel;
    for (std::int64_t k = 1; k <= steps; ++k) {
      const double t = double(k) * grid_.dt;
      const InertialState there = plan.goes_on_at(step_ + k, grid_.dt);
      const double faster = std::min(now.v * t + 0.5 * body.max_accel * t * t, cruise * t);
      const double gap = drivers_gap(driven.road, now.v, body.max_decel, there.v, their_decel);
      if (contacts.blocks(there.s, now.s + now.v * t, now.s + faster + gap)) return true;
    }
    return false;
  });
}

void Coordinator::hand_back(const std::string& id) {
  const Driven& driven = driven_.at(id);
  traffic_.hand_back(id);
  handed_back_.push_back(id);
  predictor_.handed_back(id, driven.corridor);
  std::erase_if(plan_.entries, [&](const auto& e) { return e.key == driven.key; });
  driven_.erase(id);
}

/// One that could not go on into the next corridor drives to the end of its own, where its driver
/// takes over.
void Coordinator::stay(const std::string& id) {
  const Driven& driven = driven_.at(id);
  const SpeedProfile* plan = plan_.find(driven.key);
  const bool ends =
      plan == nullptr || (plan->complete && plan->end() <= step_ + grid_.steps_per_decision);
  if (ends) hand_back(id);
}

}  // namespace mvtp
