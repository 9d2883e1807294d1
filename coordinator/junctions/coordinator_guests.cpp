// Which guests may go over junctions: drivers who are not under control, and people on foot.

#include <algorithm>
#include <cmath>
#include <limits>

#include "coordinator/drivers/human_drivers.hpp"
#include "coordinator/drivers/room_behind.hpp"
#include "coordinator/junctions/coordinator.hpp"
#include "coordinator/junctions/referee.hpp"
#include "coordinator/prediction/following.hpp"

namespace mvtp {

/// Would one of the guests who are to go touch somebody under control? Who is within their margins
/// already is not kept clear of them by its plan. At a light, not whom he follows; at the gate
/// either of them may come to rest inside, where others are let through. Notes who is blocking.
bool Coordinator::touches_guests(const std::vector<std::string>& guests, const Trial& trial) {
  const PathLibrary& library = corridors_.library();
  bool touches = false;
  for (const std::string& guest : guests) {
    const VehicleState* state = find_state(guest);
    if (state == nullptr) continue;  // people: see is_clear_of()
    const bool at_gate = is_at_gate({guest});
    const std::vector<Forecast> passages = predict_one(*state, trial.guests);
    for (const JointPlan::Entry& e : trial.decision.plan.entries) {
      const int path = trial.paths.at(e.key);
      const bool is_hit = std::ranges::any_of(passages, [&](const Forecast& passage) {
        if (!at_gate && follows(passage, {path, e.profile->at(step_).s}, library)) return false;
        return touches_passage(library, path, *e.profile, passage, step_);
      });
      if (is_hit) blocking_guests_.insert(e.key);
      touches |= is_hit;
    }
  }
  return touches;
}

/// Does somebody behind its line, not yet out of the junction, stand there for a while? It may be
/// blocking a guest for whom it waits.
/// @param zone  in which that counts; none: in any.
bool Coordinator::waits_inside(const Trial& trial, std::optional<int> zone) const {
  const std::int64_t a_while = step_ + 2 * grid_.steps_per_decision;
  return std::ranges::any_of(driven_, [&](const auto& entry) {
    const RoadVehicle& v = entry.second.road;
    if (zone && zone_of(entry.second.corridor) != *zone) return false;
    const double out = v.s_exit_lane + corridors_.library().body(v.path).length();
    if (v.stop_lines.empty() || v.now.s <= v.stop_lines.front() || v.now.s >= out) return false;
    const SpeedProfile* plan = trial.decision.plan.find(v.key);
    if (plan == nullptr) return false;
    const InertialState then = state_at(*plan, a_while);
    return then.v == 0.0 && then.s < out;
  });
}

/// What people do in the green of these crossings.
std::vector<Forecast> Coordinator::expect_people(const std::vector<std::string>& crossings) {
  std::vector<Forecast> forecasts;
  if (!people_) return forecasts;
  for (People::Expected& person : people_->expect(crossings)) {
    if (std::ranges::count(crossings, people_->id_of(person.crossing)) == 0) continue;
    forecasts.push_back(std::move(person.forecast));
  }
  return forecasts;
}

/// Could a vehicle with this plan meet one of these people?
bool Coordinator::meets_one(const std::vector<Forecast>& people, int path,
                            const SpeedProfile& plan) const {
  constexpr double kWhole = SpeedProfile::kDeparted / 2.0;
  return std::ranges::any_of(people, [&](const Forecast& f) {
    return may_meet(corridors_.library().contacts(path, f.vehicle.path), {plan, plan}, kWhole,
                    {f.earliest, *f.latest}, kWhole, step_);
  });
}

/// Does nobody under control come where these drivers and people may be? Planning lets a vehicle
/// brake fully wherever it is; a green is not shown on that.
bool Coordinator::is_clear_of(const std::vector<std::string>& guests, const Trial& trial) {
  const std::vector<Forecast> people = expect_people(guests);
  return std::ranges::none_of(trial.decision.plan.entries, [&](const JointPlan::Entry& e) {
    const auto path = trial.paths.find(e.key);
    if (path == trial.paths.end()) return false;
    return (humans_ && humans_->may_meet(guests, path->second, *e.profile)) ||
           meets_one(people, path->second, *e.profile);
  });
}

/// Could a driver meet somebody else, of whose slack he keeps clear?
bool Coordinator::may_touch(const Forecast& driver, const Forecast& other) const {
  const auto tube = [](const Forecast& f) {
    return TubeView(f.earliest, f.latest ? *f.latest : f.earliest);
  };
  constexpr double kWhole = SpeedProfile::kDeparted / 2.0;
  return may_meet(corridors_.library().contacts(driver.vehicle.path, other.vehicle.path),
                  tube(driver), kWhole, tube(other), kWhole, step_, other.slack_before,
                  other.slack_behind);
}

/// Could vehicles that keep their drivers and people meet, if these pass too? Only where one of
/// them has not been let pass before.
bool Coordinator::may_meet_people(const std::vector<std::string>& guests) {
  if (!people_) return false;
  const auto is_new = [&](const std::string& id) { return std::ranges::count(guests, id) > 0; };
  std::vector<std::pair<bool, Forecast>> passing;
  for (const VehicleState& v : traffic_.vehicles()) {
    const bool goes = is_new(v.id) || gate_.passes(v.id) || (humans_ && humans_->passes(v.id));
    if (!goes || driven_.contains(v.id)) continue;
    for (Forecast& f : predict_one(v, guests)) passing.emplace_back(is_new(v.id), std::move(f));
  }
  return std::ranges::any_of(people_->expect(guests), [&](const People::Expected& person) {
    const bool walks_now = is_new(people_->id_of(person.crossing));
    return std::ranges::any_of(passing, [&](const auto& entry) {
      const auto& [drives_now, v] = entry;
      return (walks_now || drives_now) && may_touch(v, person.forecast);
    });
  });
}

/// Do the lights of drivers among them cross those of people?
bool Coordinator::exclude_each_other(const std::vector<std::string>& guests,
                                     const std::vector<std::string>& others) const {
  if (!people_ || !humans_) return false;
  const auto excludes = [&](const std::string& crossing, const std::string& driver) {
    return people_->knows(crossing) && humans_->knows(driver) &&
           humans_->is_crossed_by(driver, people_->light_of(crossing));
  };
  return std::ranges::any_of(guests, [&](const std::string& a) {
    return std::ranges::any_of(
        others, [&](const std::string& b) { return excludes(a, b) || excludes(b, a); });
  });
}

/// Does one of them get over the junction without a light?
bool Coordinator::is_at_gate(const std::vector<std::string>& guests) const {
  return std::ranges::any_of(guests, [&](const std::string& guest) {
    return !(people_ && people_->knows(guest)) && !(humans_ && humans_->knows(guest));
  });
}

/// What it is worth to those under control that these pass now [s]; at the gate whatever it costs.
double Coordinator::worth(const std::vector<std::string>& guests) const {
  if (is_at_gate(guests)) return std::numeric_limits<double>::infinity();
  return (people_ ? people_->worth(guests) : 0.0) + (humans_ ? humans_->worth(guests) : 0.0);
}

/// The passage of a guest is planned.
void Coordinator::let_pass(const std::string& guest) {
  if (people_ && people_->knows(guest)) {
    people_->grant(guest);
  } else if (humans_ && humans_->knows(guest)) {
    humans_->grant(guest);
  } else {
    gate_.let_through(guest);
  }
}

/// Nobody is under control: human drivers who wait may go, and people.
void Coordinator::admit_guests_freely() {
  for (const auto& group : groups_of_guests()) {
    if (may_meet_people(group)) continue;
    for (const std::string& guest : group) let_pass(guest);
  }
}

/// A human-driven vehicle near a stop line, or behind one.
void Coordinator::see_guest(const VehicleState& v, const CourseQuery& query) {
  const std::optional<CourseFinder::LineAhead> line = finder_.line_ahead(query);
  if (see_human(v, query, line)) return;
  const Vehicle& body = type_of(v.type).body;
  const double clear = body.length() + kClearOfJunction;
  const Lane& lane = graph_.lane(query.lane);
  const bool is_inside = graph_.edge_of(query.lane) == LaneGraph::kNone;
  Gate::Place place{.is_inside = finder_.is_inside(query.lane),
                    .leads_on = is_inside || query.edges.size() < 2 ||
                                !graph_.links_between(query.lane, query.edges[1]).empty(),
                    .is_clear = !is_inside && query.position > clear};
  if (line && line->is_near()) {
    ++guest_sightings_;
    place.line = line->edge;
    place.to_line = line->distance;
    place.to_hold =
        is_inside ? -1.0 : std::max(0.0, std::min(line->distance, lane.length - query.position));
    place.has_room = lane.length > clear;
    place.is_between = lane.length < options_.corridors.chain;
  } else if (place.is_clear || !gate_.passes(v.id)) {
    return;
  }
  gate_.see(v, place, body);
}

/// A driver who gets his green from us, or who has had it and is still inside the junction.
bool Coordinator::see_human(const VehicleState& v, const CourseQuery& query,
                            const std::optional<CourseFinder::LineAhead>& line) {
  if (greens_ && greens_->governs(query)) return true;
  if (!humans_) return false;
  if (!owns_signals()) return humans_->decides_for(query);  // the signal's own program does
  if (humans_->is_inside(query.lane)) {
    if (!humans_->knows(v.id)) return false;
    humans_->see(v, query, 0.0, type_of(v.type));
    return true;
  }
  if (!line || !line->is_near() || !humans_->decides_for(query)) return false;
  ++guest_sightings_;
  humans_->see(v, query, line->distance, type_of(v.type));
  return true;
}

}  // namespace mvtp
