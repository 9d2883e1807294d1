// Guests at the gate: which of them may go over their lines next, beside each other and those who
// pass, and with room behind the junction.

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "coordinator/drivers/room_behind.hpp"
#include "coordinator/junctions/coordinator.hpp"
#include "coordinator/prediction/following.hpp"

namespace mvtp {

/// What guests at the gate have around them, at one decision.
class Coordinator::GateView {
 public:
  explicit GateView(Coordinator& coordinator) : c_(coordinator) {}

  [[nodiscard]] bool is_first(const std::string& id);
  [[nodiscard]] bool may_meet(const Gate::Pair& pair);
  [[nodiscard]] bool blocks(const std::string& a, double to_hold, const std::string& b);

 private:
  /// A lane behind a junction, on the path of a guest who could be held there.
  struct WaitingPlace {
    int corridor = 0;
    int lane = 0;
    double from = 0.0;  ///< [m] station of the front bumper when it enters the lane
  };
  /// Those who pass, and the lanes where they may come to stand.
  using WaitingPlaces = std::vector<std::pair<const VehicleState*, int>>;

  [[nodiscard]] const std::vector<Forecast>& passages(const std::string& id, bool stays = false);
  [[nodiscard]] std::vector<HeldVehicle> find_held();
  [[nodiscard]] double room_to_held(const VehicleState& v) const;
  [[nodiscard]] bool meet(const Forecast& a, const Forecast& b, bool from_one_lane) const;
  [[nodiscard]] bool is_first_on_lane(const VehicleState& v) const;
  [[nodiscard]] std::optional<WaitingPlace> waiting_place(const VehicleState& v);
  [[nodiscard]] WaitingPlaces waiting_places();
  [[nodiscard]] bool has_room_behind(const VehicleState& v);

  Coordinator& c_;
  std::map<std::pair<std::string, bool>, std::vector<Forecast>> passages_;
  std::optional<std::vector<HeldVehicle>> held_;
  std::optional<WaitingPlaces> taken_;
};

/// Guests at the gate who may pass beside each other and those who pass.
std::vector<std::string> Coordinator::guests_at_gate() {
  GateView view(*this);
  return gate_.propose(
      {.is_first = [&](const std::string& id) { return view.is_first(id); },
       .may_meet = [&](const Gate::Pair& pair) { return view.may_meet(pair); },
       .blocks = [&](const std::string& a, double to_hold,
                     const std::string& b) { return view.blocks(a, to_hold, b); },
       .waits_for_people = [&](const std::string& id) { return may_meet_people({id}); }});
}

/// What it may do if it passes, or if it stays before its line: not through those who are held
/// ahead of it. Of one who is to pass, nobody is.
const std::vector<Forecast>& Coordinator::GateView::passages(const std::string& id, bool stays) {
  const auto [known, is_new] = passages_.try_emplace({id, stays});
  std::vector<Forecast>& forecasts = known->second;
  const VehicleState* state = is_new ? c_.find_state(id) : nullptr;
  if (state == nullptr) return forecasts;
  std::vector<std::string> guests;
  if (!stays) guests.push_back(id);
  forecasts = c_.predict_one(*state, guests);
  if (!stays && !c_.gate_.passes(id)) return forecasts;
  if (!held_) held_ = find_held();
  for (Forecast& f : forecasts) {
    if (stays && f.held) f.earliest = *f.held;
    stay_behind(f, *held_, c_.corridors_.library());
  }
  return forecasts;
}

std::vector<HeldVehicle> Coordinator::GateView::find_held() {
  std::vector<HeldVehicle> held;
  for (const VehicleState& v : c_.traffic_.vehicles()) {
    if (!c_.gate_.holds(v.id)) continue;
    const double room = room_to_held(v);
    for (const Forecast& f : c_.predict_one(v, {})) {
      const double s = f.vehicle.now.s;
      const double line = (f.held ? *f.held : f.earliest).states.back().s;
      held.push_back({{f.vehicle.path, s}, std::min(line, s + room)});
    }
  }
  return held;
}

/// How far it may move up behind the next one who is held on its lane [m].
double Coordinator::GateView::room_to_held(const VehicleState& v) const {
  double room = std::numeric_limits<double>::infinity();
  for (const VehicleState& other : c_.traffic_.vehicles()) {
    const double ahead = other.lane_position - v.lane_position;
    if (ahead <= 0.0 || other.lane != v.lane || !c_.gate_.holds(other.id)) continue;
    room = std::min(room, ahead - c_.type_of(other.type).body.length());
  }
  return room;
}

bool Coordinator::GateView::may_meet(const Gate::Pair& pair) {
  return std::ranges::any_of(passages(pair.id), [&](const Forecast& f) {
    return std::ranges::any_of(passages(pair.other, pair.other_stays),
                               [&](const Forecast& g) { return meet(f, g, pair.from_one_lane); });
  });
}

bool Coordinator::GateView::meet(const Forecast& a, const Forecast& b, bool from_one_lane) const {
  const PathLibrary& library = c_.corridors_.library();
  if (from_one_lane) {
    return library.contacts(a.vehicle.path, b.vehicle.path)
        .parts_and_meets_again(a.vehicle.now.s, b.vehicle.now.s);
  }
  return c_.may_touch(a, b) && !merges_behind(a, b, library, c_.grid_.dt) &&
         !merges_behind(b, a, library, c_.grid_.dt);
}

/// Would `a`, held so many metres further on, stand on the path of `b`, or of somebody with a plan?
bool Coordinator::GateView::blocks(const std::string& a, double to_hold, const std::string& b) {
  return std::ranges::any_of(passages(a), [&](const Forecast& f) {
    const auto is_over = [&](const RoadVehicle& other) {
      return c_.corridors_.library()
          .contacts(f.vehicle.path, other.path)
          .blocks(f.vehicle.now.s + to_hold, other.now.s, SpeedProfile::kDeparted);
    };
    return std::ranges::any_of(passages(b),
                               [&](const Forecast& g) { return is_over(g.vehicle); }) ||
           std::ranges::any_of(c_.driven_,
                               [&](const auto& entry) { return is_over(entry.second.road); });
  });
}

/// Is nobody ahead of it on its lane but guests who are let through, and room for it behind?
bool Coordinator::GateView::is_first(const std::string& id) {
  const VehicleState* state = c_.find_state(id);
  return state != nullptr && is_first_on_lane(*state) && has_room_behind(*state);
}

bool Coordinator::GateView::is_first_on_lane(const VehicleState& v) const {
  return std::ranges::none_of(c_.traffic_.vehicles(), [&](const VehicleState& other) {
    return other.lane_position > v.lane_position && other.lane == v.lane &&
           !c_.gate_.passes(other.id);
  });
}

/// The next lane behind a junction where a guest could be held clear of it; nullopt if its path is
/// not known.
auto Coordinator::GateView::waiting_place(const VehicleState& v) -> std::optional<WaitingPlace> {
  const std::vector<int> route = c_.route_of(v);
  const CourseQuery query = c_.query_for(v, route);
  const Vehicle& body = c_.type_of(v.type).body;
  const std::optional<Predictor::Placed> placed = c_.predictor_.place(v, query, body);
  if (!placed) return std::nullopt;
  const std::optional<CourseFinder::LineAhead> line = c_.finder_.line_ahead(query);
  const bool is_inside = c_.graph_.edge_of(query.lane) == LaneGraph::kNone;
  const double from = placed->road.now.s + (line && !is_inside ? line->distance : 0.0);
  const Corridor& corridor = c_.corridors_[placed->corridor];
  for (std::size_t i = 0; i < corridor.stations.size(); ++i) {
    const int lane = corridor.course.pieces[i].lane;
    const bool is_behind =
        corridor.stations[i] > from && c_.graph_.edge_of(lane) != LaneGraph::kNone;
    if (!is_behind || c_.graph_.lane(lane).length < body.length() + kClearOfJunction) continue;
    return WaitingPlace{placed->corridor, lane, corridor.stations[i]};
  }
  return std::nullopt;
}

auto Coordinator::GateView::waiting_places() -> WaitingPlaces {
  WaitingPlaces taken;
  for (const VehicleState& v : c_.traffic_.vehicles()) {
    if (!c_.gate_.passes(v.id)) continue;
    const std::optional<WaitingPlace> place = waiting_place(v);
    if (place) taken.emplace_back(&v, place->lane);
  }
  return taken;
}

/// Is there room for a guest behind the next junction, should everybody there stop, and those who
/// are let through?
bool Coordinator::GateView::has_room_behind(const VehicleState& v) {
  const std::optional<WaitingPlace> place = waiting_place(v);
  if (!place) return true;
  if (!taken_) taken_ = waiting_places();
  const VehicleType& type = c_.type_of(v.type);
  double needed = place->from + type.body.length() + kClearOfJunction;
  for (const auto& [other, lane] : *taken_) {
    if (lane != place->lane || other->id == v.id || !c_.gate_.passes(other->id)) continue;
    needed += c_.type_of(other->type).body.length() + c_.type_of(other->type).min_gap;
  }
  const double tail = first_tail_at_rest(
      c_.corridors_[place->corridor], c_.graph_, place->from, type.body.max_decel,
      c_.traffic_.vehicles(), [&](const VehicleState& other) {
        return other.id == v.id ? std::nullopt
                                : std::optional(c_.type_of(other.type).body.length());
      });
  return tail >= needed;
}

}  // namespace mvtp
