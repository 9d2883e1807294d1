// Guests at the gate: which of them may go over their lines next, beside each other and those who
// pass, and with room behind the junction.

#include <algorithm>
#include <map>
#include <optional>

#include "coordinator/drivers/room_behind.hpp"
#include "coordinator/junctions/coordinator.hpp"

namespace mvtp {

/// Guests at the gate who may pass beside each other and those who pass.
std::vector<std::string> Coordinator::guests_at_gate() {
  std::map<std::string, std::vector<Forecast>> passages;
  const auto passages_of = [&](const std::string& id) -> const std::vector<Forecast>& {
    const auto [known, is_new] = passages.try_emplace(id);
    const VehicleState* state = is_new ? find_state(id) : nullptr;
    if (state != nullptr) known->second = predict_one(*state, {id});
    return known->second;
  };
  std::optional<WaitingPlaces> taken;
  const auto is_first = [&](const std::string& id) {
    const VehicleState* state = find_state(id);
    if (state == nullptr || !is_first_on_lane(*state)) return false;
    if (!taken) taken = waiting_places();
    return has_room_behind(*state, *taken);
  };
  const auto may_meet = [&](const std::string& a, const std::string& b, bool from_one_lane) {
    return std::ranges::any_of(passages_of(a), [&](const Forecast& f) {
      return std::ranges::any_of(passages_of(b), [&](const Forecast& g) {
        if (!from_one_lane) return may_touch(f, g);
        return corridors_.library()
            .contacts(f.vehicle.path, g.vehicle.path)
            .parts_and_meets_again(f.vehicle.now.s, g.vehicle.now.s);
      });
    });
  };
  const auto blocks = [&](const std::string& a, double to_hold, const std::string& b) {
    return std::ranges::any_of(passages_of(a), [&](const Forecast& f) {
      const auto is_over = [&](const RoadVehicle& other) {
        return corridors_.library()
            .contacts(f.vehicle.path, other.path)
            .blocks(f.vehicle.now.s + to_hold, other.now.s, SpeedProfile::kDeparted);
      };
      return std::ranges::any_of(passages_of(b),
                                 [&](const Forecast& g) { return is_over(g.vehicle); }) ||
             std::ranges::any_of(driven_,
                                 [&](const auto& entry) { return is_over(entry.second.road); });
    });
  };
  const auto waits_for_people = [&](const std::string& id) { return may_meet_people({id}); };
  return gate_.propose({is_first, may_meet, blocks, waits_for_people});
}

/// Is nobody ahead of it on its lane but guests who are let through?
bool Coordinator::is_first_on_lane(const VehicleState& v) const {
  return std::ranges::none_of(traffic_.vehicles(), [&](const VehicleState& other) {
    return other.lane_position > v.lane_position && other.lane == v.lane && !gate_.passes(other.id);
  });
}

/// The next lane behind a junction where a guest could be held clear of it; nullopt if its path is
/// not known.
std::optional<Coordinator::WaitingPlace> Coordinator::waiting_place(const VehicleState& v) {
  const std::vector<int> route = route_of(v);
  const CourseQuery query = query_for(v, route);
  const Vehicle& body = type_of(v.type).body;
  const std::optional<Predictor::Placed> placed = predictor_.place(v, query, body);
  if (!placed) return std::nullopt;
  const std::optional<CourseFinder::LineAhead> line = finder_.line_ahead(query);
  const bool is_inside = graph_.edge_of(query.lane) == LaneGraph::kNone;
  const double from = placed->road.now.s + (line && !is_inside ? line->distance : 0.0);
  const Corridor& corridor = corridors_[placed->corridor];
  for (std::size_t i = 0; i < corridor.stations.size(); ++i) {
    const int lane = corridor.course.pieces[i].lane;
    const bool is_behind = corridor.stations[i] > from && graph_.edge_of(lane) != LaneGraph::kNone;
    if (!is_behind || graph_.lane(lane).length < body.length() + kClearOfJunction) continue;
    return WaitingPlace{placed->corridor, lane, corridor.stations[i]};
  }
  return std::nullopt;
}

Coordinator::WaitingPlaces Coordinator::waiting_places() {
  WaitingPlaces taken;
  for (const VehicleState& v : traffic_.vehicles()) {
    if (!gate_.passes(v.id)) continue;
    const std::optional<WaitingPlace> place = waiting_place(v);
    if (place) taken.emplace_back(&v, place->lane);
  }
  return taken;
}

/// Is there room for a guest behind the next junction, should everybody there stop, and those who
/// are let through?
bool Coordinator::has_room_behind(const VehicleState& v, const WaitingPlaces& taken) {
  const std::optional<WaitingPlace> place = waiting_place(v);
  if (!place) return true;
  const VehicleType& type = type_of(v.type);
  double needed = place->from + type.body.length() + kClearOfJunction;
  for (const auto& [other, lane] : taken) {
    if (lane != place->lane || other->id == v.id || !gate_.passes(other->id)) continue;
    needed += type_of(other->type).body.length() + type_of(other->type).min_gap;
  }
  const double tail = first_tail_at_rest(
      corridors_[place->corridor], graph_, place->from, type.body.max_decel, traffic_.vehicles(),
      [&](const VehicleState& other) {
        return other.id == v.id ? std::nullopt : std::optional(type_of(other.type).body.length());
      });
  return tail >= needed;
}

}  // namespace mvtp
