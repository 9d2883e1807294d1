#include "coordinator/coordinator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "coordinator/audit.hpp"
#include "coordinator/referee.hpp"
#include "planner/road/emergency_braking.hpp"
#include "planner/search/draws.hpp"

namespace mvtp {
namespace {

/// After so many refusals in a row a group gets its plan in spite of the referee: old plans end,
/// and whoever stands at the end of one stands in the way of all others for good.
constexpr int kMostRefusals = 6;
constexpr double kSpareRoom = 10.0;  ///< [m] before a line, beside what it takes to stop there
constexpr double kPatience = 5.0;    ///< [s] without a complete plan until one that stands is stuck
constexpr double kApproachReserve = 0.9;  ///< share of its acceleration used off its path,
constexpr double kLeastShare = 0.5;       ///< and where the path bends besides

/// Comfortable braking towards lower speed limits.
double envelope_braking(const Vehicle& body) { return std::min(3.5, 0.8 * body.max_decel); }

/// Where a plan has a vehicle at step k; at its end it stays.
InertialState state_at(const PathTrajectory& t, std::int64_t k) {
  return k < t.end() ? t.at(k) : t.states.back();
}

/// May it be taken over later? It has room to stop before its line.
bool can_wait(double speed, const Vehicle& body, double to_line) {
  return to_line >= stopping_distance(speed, envelope_braking(body)) + kSpareRoom;
}

/// The classes of road vehicles; what runs on rails, on foot or on two wheels without an engine
/// keeps its own driver.
bool is_car_like(const std::string& vehicle_class) {
  constexpr std::array<std::string_view, 12> kNot = {
      "pedestrian",    "bicycle", "tram",      "rail",      "rail_urban", "rail_fast",
      "rail_electric", "ship",    "container", "cable_car", "subway",     "aircraft"};
  return std::ranges::find(kNot, vehicle_class) == kNot.end();
}

}  // namespace

Coordinator::Coordinator(Traffic& traffic, const DrivableArea& area,
                         const CoordinatorOptions& options)
    : traffic_(traffic),
      options_(options),
      graph_(traffic.network()),
      coordinated_(select_junctions(graph_, options.junctions, options.corridors.chain)),
      finder_(graph_, coordinated_, options.corridors),
      corridors_(graph_, area, options.limits),
      area_(area),
      predictor_(graph_, finder_, corridors_, options.corridors.takeover),
      gate_(traffic) {
  grid_.dt = traffic.step_length();
  grid_.steps_per_decision = std::max(1, int(std::lround(options.decision / grid_.dt)));
  if (options.share.is_whole()) return;
  const auto plan_of = [this](const std::string& id) -> const PathTrajectory* {
    const auto driven = driven_.find(id);
    return driven == driven_.end() ? nullptr : plan_.find(driven->second.key);
  };
  humans_.emplace(traffic, graph_, corridors_, predictor_, coordinated_, options.signals, grid_,
                  plan_of);
}

std::vector<ZoneFigures> Coordinator::zones() const {
  std::vector<ZoneFigures> zones;
  for (const ControlZone& zone : partition(graph_, coordinated_, options_.corridors.chain)) {
    ZoneFigures& figures = zones.emplace_back();
    for (const int j : zone.junctions) figures.junctions.push_back(graph_.junction(j).id);
    figures.corridors = zone.connections;
  }
  return zones;
}

std::vector<LeftToTraffic> Coordinator::left_to_sumo() const {
  std::vector<LeftToTraffic> left;
  for (const auto& [what, why] : undriven_) left.push_back({what, why});
  return left;
}

void Coordinator::decide() {
  taken_over_.clear();
  handed_back_.clear();
  forget_the_vanished();
  follow_plans();
  if (step_ % grid_.steps_per_decision == 0) {
    remember_lanes();
    replan();
    if (owns_signals()) humans_->settle();
  } else {
    static_cast<void>(leave_corridors(/*may_go_on=*/false));
    hold_departures();
    brake_for_surprises();
  }
}

void Coordinator::act() {
  place_all();
  ++step_;
}

void Coordinator::follow_plans() {
  for (auto& [id, driven] : driven_) {
    driven.road.now = state_at(*plan_.find(driven.key), step_);
  }
}

/// The traffic may take a vehicle off the road whenever it likes.
void Coordinator::forget_the_vanished() {
  std::erase_if(turned_away_,
                [&](const auto& entry) { return find_state(entry.first) == nullptr; });
  std::erase_if(driven_, [&](const auto& entry) {
    const auto& [id, driven] = entry;
    if (find_state(id) != nullptr && traffic_.is_taken_over(id)) return false;
    std::erase_if(plan_.entries, [&](const auto& e) { return e.key == driven.key; });
    return true;
  });
}

void Coordinator::replan() {
  notice_the_stuck();
  std::map<std::string, Driven> arrivals = leave_corridors(/*may_go_on=*/true);
  const std::vector<Newcomer> newcomers = find_newcomers();
  if (planner_is_dead()) return hold_back(newcomers);
  if (newcomers.empty() && driven_.empty()) return admit_guests_freely();

  const auto begin = std::chrono::steady_clock::now();
  for (const Newcomer& n : newcomers) arrivals.emplace(n.state->id, admit(n, next_key_++));
  const std::vector<std::int64_t> upset = stagnating_groups();
  const Trial trial = best_trial(arrivals, upset);
  Replan record{.time = traffic_.time(),
                .vehicles = int(driven_.size() + newcomers.size()),
                .newcomers = int(newcomers.size()),
                .forecasts = int(trial.forecasts.size()),
                .groups = trial.decision.groups,
                .stepped = trial.decision.stepped,
                .cost = trial.decision.cost};
  record.ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  const bool late =
      traffic_.time() >= options_.budget_from && record.ms > options_.replan_budget_ms;
  record.fallback = late || !trial.refused.empty();
  replans_.push_back(record);
  accept(trial, late, arrivals);
}

/// The plan with all arrivals; with guests that go over junctions too, if that leaves nobody
/// without a plan; without those arrivals that come too late, that get no complete plan, or one
/// that the referee refuses.
Coordinator::Trial Coordinator::best_trial(const std::map<std::string, Driven>& arrivals,
                                           const std::vector<std::int64_t>& upset) {
  std::set<std::string> excluded = too_late(arrivals);
  if (owns_signals()) return best_trial_with_humans(arrivals, excluded, upset);
  std::optional<Trial> with_guests;
  for (const std::vector<std::string>& guests : offers()) {
    with_guests = plan_trial(arrivals, excluded, upset, guests);
    if (with_guests->decision.stepped == 0 && with_guests->refused.empty() &&
        !waits_inside(*with_guests)) {
      return *with_guests;
    }
  }
  Trial trial = plan_trial(arrivals, excluded, upset, {});
  const bool worse = with_guests && (with_guests->decision.stepped > trial.decision.stepped ||
                                     with_guests->refused.size() > trial.refused.size() ||
                                     (waits_inside(*with_guests) && !waits_inside(trial)));
  if (with_guests && !worse) trial = *std::move(with_guests);
  return without_the_late(std::move(trial), arrivals, std::move(excluded), upset);
}

/// The same trial without those arrivals that get no complete plan, or one that is refused.
Coordinator::Trial Coordinator::without_the_late(Trial trial,
                                                 const std::map<std::string, Driven>& arrivals,
                                                 std::set<std::string> excluded,
                                                 const std::vector<std::int64_t>& upset) {
  for (const bool whole_groups : {false, true}) {
    const std::set<std::string> more = better_later(trial, arrivals, whole_groups);
    if (more.empty()) continue;
    excluded.insert(more.begin(), more.end());
    trial = plan_trial(arrivals, excluded, upset, std::vector<std::string>(trial.guests));
  }
  return trial;
}

/// Does somebody behind its line, not yet out of the junction, stand there for a while? It may be
/// in the way of a guest for whom it waits.
bool Coordinator::waits_inside(const Trial& trial) const {
  const std::int64_t a_while = step_ + 2 * grid_.steps_per_decision;
  return std::ranges::any_of(driven_, [&](const auto& entry) {
    const RoadVehicle& v = entry.second.road;
    const double out = v.s_exit_lane + corridors_.library().body(v.path).length();
    if (v.stop_lines.empty() || v.now.s <= v.stop_lines.front() || v.now.s >= out) return false;
    const PathTrajectory* plan = trial.decision.plan.find(v.key);
    if (plan == nullptr) return false;
    const InertialState then = state_at(*plan, a_while);
    return then.v == 0.0 && then.s < out;
  });
}

/// The plan with as many human drivers getting green as is possible, and worth what it costs the
/// vehicles under control.
Coordinator::Trial Coordinator::best_trial_with_humans(
    const std::map<std::string, Driven>& arrivals, const std::set<std::string>& excluded,
    const std::vector<std::int64_t>& upset) {
  Trial trial =
      without_the_late(plan_trial(arrivals, excluded, upset, {}), arrivals, excluded, upset);
  for (const std::vector<std::string>& guests : offers()) {
    Trial with = plan_trial(arrivals, trial.excluded, upset, guests);
    const bool worse = with.decision.stepped > trial.decision.stepped || !with.refused.empty();
    if (worse || !is_clear_of(guests, with)) continue;
    const bool comparable = trial.decision.stepped == 0;
    const double loss = with.decision.cost - trial.decision.cost;
    if (comparable && loss > humans_->worth(guests)) continue;
    return with;
  }
  return trial;
}

/// Does nobody under control come where these drivers may be? Planning lets a vehicle brake fully
/// wherever it is; a green is not shown on that.
bool Coordinator::is_clear_of(const std::vector<std::string>& guests, const Trial& trial) const {
  for (const JointPlan::Entry& e : trial.decision.plan.entries) {
    const auto path = trial.paths.find(e.key);
    if (path == trial.paths.end()) continue;
    if (humans_->may_meet(guests, path->second, *e.trajectory)) return false;
  }
  return true;
}

/// Guests who may go over junctions now, in the order in which that is tried: all at once, or else
/// the first alone. Drivers at signals come in groups that only go together.
std::vector<std::vector<std::string>> Coordinator::offers() {
  std::vector<std::vector<std::string>> groups;
  for (const std::string& guest : gate_.propose()) groups.push_back({guest});
  if (owns_signals()) {
    for (auto& group : humans_->propose()) groups.push_back(std::move(group));
  }
  if (groups.size() < 2) return groups;
  std::vector<std::string> all;
  for (const auto& group : groups) all.insert(all.end(), group.begin(), group.end());
  return {all, groups.front()};
}

/// The passage of a guest is planned.
void Coordinator::let_pass(const std::string& guest) {
  if (humans_ && humans_->knows(guest)) {
    humans_->grant(guest);
  } else {
    gate_.let_through(guest);
  }
}

/// Arrivals without a complete plan, and those that the referee finds in contact: of two of them
/// the one further back.
/// @param whole_groups  all of a group that it refuses.
std::set<std::string> Coordinator::better_later(const Trial& trial,
                                                const std::map<std::string, Driven>& arrivals,
                                                bool whole_groups) const {
  std::set<std::int64_t> keys;
  for (const auto& [id, arrival] : arrivals) {
    if (!trial.excluded.contains(id)) keys.insert(arrival.key);
  }
  std::set<std::int64_t> touching;
  for (const PlannedContact& c : trial.contacts) {
    touching.insert(keys.contains(c.second) ? c.second : c.first);
  }
  std::set<std::string> later;
  for (const auto& [id, arrival] : arrivals) {
    if (!keys.contains(arrival.key)) continue;
    const bool refused = std::ranges::any_of(trial.refused, [&](std::size_t g) {
      return std::ranges::binary_search(trial.decision.members[g], arrival.key);
    });
    const bool has_plan = trial.decision.plan.find(arrival.key)->complete;
    if ((refused && (whole_groups || touching.contains(arrival.key))) ||
        (!has_plan && may_come_later(id, arrival))) {
      later.insert(id);
    }
  }
  return later;
}

/// Arrivals whose new paths lead into somebody, however hard they brake: those are better off as
/// they are. So are the others until they are admitted.
std::set<std::string> Coordinator::too_late(const std::map<std::string, Driven>& arrivals) {
  std::set<std::string> late;
  if (arrivals.empty()) return late;
  RoadScene now{.library = &corridors_.library(), .grid = grid_, .step = step_};
  std::map<std::string, const Driven*> present;
  for (const auto& [id, driven] : driven_) {
    present[id] = &driven;
    now.vehicles.push_back(driven.road);
  }
  std::map<std::int64_t, std::string> in_order;
  std::map<std::string, std::vector<Forecast>> with_drivers;
  for (const auto& [id, arrival] : arrivals) {
    in_order.emplace(arrival.key, id);
    if (!driven_.contains(id)) with_drivers[id] = predict_one(*find_state(id), {});
    present[id] = &arrival;
  }
  now.forecasts = predict_others(present, {});
  for (const auto& [key, id] : in_order) {
    const RoadVehicle& road = arrivals.at(id).road;
    const auto runs_into = [&](const RoadVehicle& other) {
      return other.key != road.key && RoadContact(now, road, other, 0.0).braking_is_too_late();
    };
    bool hits = std::ranges::any_of(now.vehicles, runs_into) ||
                std::ranges::any_of(now.forecasts, runs_into, &Forecast::vehicle);
    for (const auto& [other, forecasts] : with_drivers) {
      hits |= other != id && std::ranges::any_of(forecasts, runs_into, &Forecast::vehicle);
    }
    if (hits) {
      late.insert(id);
    } else {
      now.vehicles.push_back(road);
    }
  }
  return late;
}

/// A newcomer waits at its line; one that goes on from another corridor has to stop before it is
/// there.
bool Coordinator::may_come_later(const std::string& id, const Driven& arrival) const {
  if (!driven_.contains(id)) return true;
  const InertialState& now = arrival.road.now;
  const double to_line = corridors_[arrival.corridor].lines.front() - now.s;
  return can_wait(now.v, corridors_.library().body(arrival.road.path),
                  to_line - now.v * grid_.decision());
}

Coordinator::Trial Coordinator::plan_trial(const std::map<std::string, Driven>& arrivals,
                                           const std::set<std::string>& excluded,
                                           const std::vector<std::int64_t>& upset,
                                           const std::vector<std::string>& guests) {
  Trial trial{.guests = guests, .excluded = excluded};
  std::map<std::string, const Driven*> present;
  for (const auto& [id, driven] : driven_) {
    // Who is at the end of its corridor and does not go on is handed back there.
    const bool ends = driven.road.now.s >= driven.road.s_end && excluded.contains(id);
    if (!ends) present[id] = &driven;
  }
  std::set<std::int64_t> arriving;
  for (const auto& [id, arrival] : arrivals) {
    if (excluded.contains(id)) continue;
    present[id] = &arrival;
    arriving.insert(arrival.key);
  }
  RoadScene now{.library = &corridors_.library(), .grid = grid_, .step = step_};
  for (const auto& [id, driven] : present) {
    now.vehicles.push_back(driven->road);
    trial.paths.emplace(driven->key, driven->road.path);
  }
  std::ranges::sort(now.vehicles, {}, &RoadVehicle::key);
  now.forecasts = trial.forecasts = predict_others(present, guests);
  prepare_tables(now);
  // The plans that vehicles follow to the end of their corridors.
  JointPlan incumbent = plan_;
  std::erase_if(incumbent.entries, [&](const auto& e) {
    return !e.trajectory->complete || arriving.contains(e.key) ||
           std::ranges::count(upset, e.key) > 0;
  });
  trial.decision =
      decide_on_road(now, incumbent, without_plan(now, incumbent, upset), options_.escot);
  trial.contacts = find_planned_contacts(now, trial.decision.plan, plan_);
  trial.refused = groups_in_contact(trial.decision.members, trial.contacts);
  return trial;
}

/// Nobody is under control: whoever waits with its own driver may go, one after the other.
void Coordinator::admit_guests_freely() {
  for (const std::string& guest : gate_.propose()) gate_.let_through(guest);
  if (!owns_signals()) return;
  for (const auto& group : humans_->propose()) {
    for (const std::string& id : group) humans_->grant(id);
  }
}

/// Contact tables of all paths in use, before threads look into them.
void Coordinator::prepare_tables(const RoadScene& now) {
  std::vector<int> paths;
  std::vector<int> others;
  for (const RoadVehicle& v : now.vehicles) paths.push_back(v.path);
  for (const Forecast& f : now.forecasts) others.push_back(f.vehicle.path);
  corridors_.library().prepare(paths, others);
}

/// Makes a trial's plan what is executed, but for groups that the referee refuses and for all if it
/// is late: those go on as before, and the newcomers among them are not taken over.
void Coordinator::accept(const Trial& trial, bool late,
                         const std::map<std::string, Driven>& arrivals) {
  std::set<std::int64_t> keep;  // keys
  std::map<std::int64_t, int> refusals;
  for (std::size_t g = 0; g < trial.decision.members.size(); ++g) {
    const auto& members = trial.decision.members[g];
    const bool refused = std::ranges::binary_search(trial.refused, g);
    int before = 0;
    for (const std::int64_t key : members) {
      const auto known = refusals_.find(key);
      if (known != refusals_.end()) before = std::max(before, known->second);
    }
    const bool obeyed = refused && before < kMostRefusals;
    if (late || obeyed) keep.insert(members.begin(), members.end());
    if (obeyed) {
      for (const std::int64_t key : members) refusals[key] = before + 1;
    }
  }
  refusals_ = std::move(refusals);
  JointPlan plan = trial.decision.plan;
  std::erase_if(plan.entries, [&](const auto& e) { return keep.contains(e.key); });
  for (const JointPlan::Entry& e : plan_.entries) {
    if (keep.contains(e.key)) plan.entries.push_back(e);
  }
  plan_ = std::move(plan);
  groups_ = trial.decision.members;
  forecasts_ = trial.forecasts;
  if (!late) {
    for (const std::string& guest : trial.guests) let_pass(guest);
  }
  for (const auto& [id, arrival] : arrivals) {
    const bool goes_on = driven_.contains(id);
    if (keep.contains(arrival.key) || trial.excluded.contains(id)) {
      if (goes_on) {
        stay(id);
      } else {
        gate_.hold(id);
        ++turned_away_[id];
      }
      continue;
    }
    driven_.insert_or_assign(id, arrival);
    turned_away_.erase(id);
    if (!goes_on) {
      gate_.release(id);
      traffic_.take_over(id);
      taken_over_.push_back(id);
    }
    announce(id, arrival);
  }
}

/// One that could not go on into the next corridor drives to the end of its own, where its driver
/// takes over.
void Coordinator::stay(const std::string& id) {
  const Driven& driven = driven_.at(id);
  const PathTrajectory* plan = plan_.find(driven.key);
  const bool ends =
      plan == nullptr || (plan->complete && plan->end() <= step_ + grid_.steps_per_decision);
  if (ends) hand_back(id);
}

/// Of the groups of the last decision, those that have not moved since though nobody in them
/// drives: a duplicate configuration [ESCoT, Alg. 2 l. 4-6]. They plan anew, in another order, at
/// random.
std::vector<std::int64_t> Coordinator::stagnating_groups() {
  std::vector<std::int64_t> upset;
  std::map<std::int64_t, InertialState> now;
  for (const auto& [id, driven] : driven_) now[driven.key] = driven.road.now;
  for (const std::vector<std::int64_t>& group : groups_) {
    std::vector<std::int64_t> there;
    bool stands = true;
    for (const std::int64_t key : group) {
      const auto state = now.find(key);
      if (state == now.end()) continue;
      const auto before = last_states_.find(key);
      stands = stands && state->second.v == 0.0 && before != last_states_.end() &&
               before->second == state->second;
      there.push_back(key);
    }
    if (!stands || there.size() < 2) continue;
    Draws draws(options_.escot.seed + std::uint64_t(step_) + std::uint64_t(there.front()));
    draws.shuffle(there);
    upset.insert(upset.begin(), there.begin(), there.end());
  }
  last_states_ = std::move(now);
  return upset;
}

/// Who has stood for long without a complete plan is stuck until the end of its corridor.
void Coordinator::notice_the_stuck() {
  std::map<std::int64_t, int> standing;
  for (auto& [id, driven] : driven_) {
    const bool stands = driven.road.now.v == 0.0 && !plan_.find(driven.key)->complete;
    if (!stands) continue;
    const auto before = standing_.find(driven.key);
    const int decisions = before == standing_.end() ? 1 : before->second + 1;
    standing.emplace(driven.key, decisions);
    driven.road.stuck |= decisions * grid_.decision() > kPatience;
  }
  standing_ = std::move(standing);
}

/// Keys of the vehicles without an incumbent, the first of them first: those of stagnating groups,
/// then all others by age.
std::vector<std::int64_t> Coordinator::without_plan(const RoadScene& now,
                                                    const JointPlan& incumbent,
                                                    const std::vector<std::int64_t>& upset) {
  std::vector<std::int64_t> order = upset;
  for (const RoadVehicle& v : now.vehicles) {
    if (!incumbent.find(v.key) && std::ranges::count(upset, v.key) == 0) order.push_back(v.key);
  }
  return order;
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

/// Hands back those at the end of their corridor; but those with a stop line near are to go on into
/// the next corridor.
std::map<std::string, Driven> Coordinator::leave_corridors(bool may_go_on) {
  std::map<std::string, Driven> going_on;
  std::vector<std::string> finished;
  for (const auto& [id, driven] : driven_) {
    if (driven.road.now.s < driven.road.s_handback) continue;
    const std::optional<Newcomer> next =
        planner_is_dead() ? std::nullopt : next_corridor(driven, *find_state(id));
    if (!next) {
      if (driver_has_room(driven) || ends_soon(driven)) finished.push_back(id);
    } else if (may_go_on) {
      Driven& arrival = going_on.emplace(id, admit(*next, driven.key)).first->second;
      // The traffic's speed is that along the lanes, which the two corridors may scale otherwise.
      arrival.road.now.v = driven.road.now.v;
    }
  }
  for (const std::string& id : finished) hand_back(id);
  return going_on;
}

/// Is there no place left for a later hand-back?
bool Coordinator::ends_soon(const Driven& driven) const {
  const InertialState& now = driven.road.now;
  return planner_is_dead() || now.s + now.v * grid_.dt >= corridors_[driven.corridor].s_latest ||
         now.s + now.v * grid_.decision() >= driven.road.s_end;
}

/// Would the driver who gets it back have his headway to whoever is ahead? Else it is driven on
/// for a while, and slows down as gently as its plan can.
bool Coordinator::driver_has_room(const Driven& driven) {
  constexpr double kSight = 60.0;  // [m]
  const Corridor& corridor = corridors_[driven.corridor];
  const InertialState& now = driven.road.now;
  const double b = corridors_.library().body(driven.road.path).max_decel;
  const Pose here = path_of(driven).at(now.s);
  return std::ranges::none_of(traffic_.vehicles(), [&](const VehicleState& v) {
    const int lane = graph_.find_lane(v.lane);
    if (lane == LaneGraph::kNone || distance(here, v.pose) > kSight) return false;
    const std::optional<double> s = corridor.station(lane, v.lane_position, now.s);
    if (!s || *s <= now.s) return false;
    const Vehicle& ahead = type_of(v.type).body;
    const double wanted = drivers_gap(driven.road, now.v, b, v.speed, ahead.max_decel);
    return *s - now.s - ahead.length() < wanted;
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

/// The corridor through the next junctions, for a vehicle near the end of its own; nullopt if there
/// is none for it, or no stop line near.
std::optional<Coordinator::Newcomer> Coordinator::next_corridor(const Driven& driven,
                                                                const VehicleState& state) {
  const Corridor& corridor = corridors_[driven.corridor];
  const std::size_t here = corridor.piece_at(driven.road.now.s);
  const CorridorPiece& piece = corridor.course.pieces[here];
  if (graph_.edge_of(piece.lane) == LaneGraph::kNone) return std::nullopt;
  // How many edges of the route lie behind.
  std::size_t done =
      graph_.edge_of(corridor.course.pieces.front().lane) == LaneGraph::kNone ? 1 : 0;
  for (std::size_t i = 0; i < here; ++i) {
    done += graph_.edge_of(corridor.course.pieces[i].lane) != LaneGraph::kNone ? 1 : 0;
  }
  std::vector<int> route(driven.route.begin() + std::ptrdiff_t(std::min(done, driven.route.size())),
                         driven.route.end());
  CourseQuery query = query_for(state, route);
  query.lane = piece.last_lane();
  query.position = (driven.road.now.s - corridor.stations[here]) / corridor.scales[here];
  std::optional<Newcomer> next = newcomer_at(state, query, route);
  if (!next) return std::nullopt;
  // What its body cannot drive is its driver's: it is taken over again behind that.
  const Corridor& ahead = corridors_[next->corridor];
  if (ahead.lines.front() - next->to_line < ahead.s_drivable) return std::nullopt;
  return next;
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
  if (!corridor.undriven.empty()) {
    const auto& pieces = corridor.course.pieces;
    undriven_.try_emplace(
        fmt::format("type {} from lane {} to lane {}", type.id,
                    graph_.lane(pieces[std::size_t(corridor.course.lines.front())].last_lane()).id,
                    graph_.lane(corridor.exit_lane).id),
        corridor.undriven);
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
  if (const std::optional<Stop> stop = traffic_.next_stop(v.id)) {
    const int edge = graph_.find_edge(stop->edge);
    const auto at = std::ranges::find(route, edge);
    if (at != route.end()) {
      query.stop_edge = std::size_t(at - route.begin());
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

/// Which normal lanes vehicles have come over: their tails may still be there.
void Coordinator::remember_lanes() {
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
    trails.emplace(v.id, trail);
  }
  trails_ = std::move(trails);
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
    const bool is_human = !options_.share.contains(v.id, v.type);
    if (is_human || !is_car_like(type_of(v.type).vehicle_class)) {
      see_guest(v, query);
    } else if (auto newcomer = newcomer_at(v, query, route)) {
      gate_.keep(v.id);
      if (!turns_yet(*newcomer)) newcomers.push_back(std::move(*newcomer));
    } else {
      see_guest(v, query);
    }
  }
  gate_.end();
  if (owns_signals()) humans_->end();
  // Whoever is nearer to the line has arrived earlier; lanes keep their order this way.
  std::ranges::stable_sort(newcomers, {}, &Newcomer::to_line);
  return newcomers;
}

/// Does it enter the network just now, its tail still behind the beginning of its first lane?
bool Coordinator::is_entering(const VehicleState& v) {
  const double length = type_of(v.type).body.length();
  const auto trail = trails_.find(v.id);
  const bool came = trail != trails_.end() && trail->second.before != LaneGraph::kNone;
  return !came && v.lane_position < length + 3.0 &&
         area_.share_outside(v.pose, type_of(v.type).body, Audit::kRoadTolerance) > 0.0;
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

/// A vehicle near a stop line that keeps its own driver.
void Coordinator::see_guest(const VehicleState& v, const CourseQuery& query) {
  const std::optional<double> to_line = finder_.distance_to_line(query);
  const bool is_inside = graph_.edge_of(query.lane) == LaneGraph::kNone;
  if (see_human(v, query, to_line)) return;
  if (to_line && *to_line <= options_.corridors.takeover) {
    ++guest_sightings_;
    const double lane_end = graph_.lane(query.lane).length - query.position;
    gate_.see(v, *to_line, is_inside ? 0.0 : std::min(*to_line, lane_end), is_first_on_lane(v),
              type_of(v.type).body);
  } else if (is_inside && gate_.passes(v.id)) {
    gate_.see(v, 0.0, 0.0, true, type_of(v.type).body);
  }
}

/// A driver who gets his green from us, or who has had it and is still inside the junction.
bool Coordinator::see_human(const VehicleState& v, const CourseQuery& query,
                            std::optional<double> to_line) {
  if (!humans_) return false;
  if (!owns_signals()) return humans_->decides_for(query);  // the signal's own program does
  if (graph_.edge_of(query.lane) == LaneGraph::kNone) {
    if (!humans_->knows(v.id)) return false;
    humans_->see(v, query, 0.0, type_of(v.type));
    return true;
  }
  const bool near = to_line && *to_line <= options_.corridors.takeover;
  if (!near || !humans_->decides_for(query)) return false;
  ++guest_sightings_;
  humans_->see(v, query, *to_line, type_of(v.type));
  return true;
}

/// Is nobody ahead of it on its lane but guests who are let through?
bool Coordinator::is_first_on_lane(const VehicleState& v) const {
  return std::ranges::none_of(traffic_.vehicles(), [&](const VehicleState& other) {
    return other.lane_position > v.lane_position && other.lane == v.lane && !gate_.passes(other.id);
  });
}

/// From where a vehicle is onto the path of a corridor, about `station` along it.
PathApproach Coordinator::approach_to(const Corridor& corridor, const VehicleState& v,
                                      double station) const {
  constexpr double kNear = 3.0;  // [m]
  const GuidePath& path = corridors_.library().path(corridor.path);
  return {path, v.pose, path.project({v.pose.x, v.pose.y}, station - kNear, station + kNear)};
}

/// Has it been turned away for long?
bool Coordinator::is_impatient(const std::string& id) const {
  const auto times = turned_away_.find(id);
  return times != turned_away_.end() && times->second * grid_.decision() > kPatience;
}

Driven Coordinator::admit(const Newcomer& newcomer, std::int64_t key) {
  const VehicleState& v = *newcomer.state;
  const VehicleType& type = type_of(v.type);
  Driven driven{.key = key, .corridor = newcomer.corridor, .route = newcomer.route};
  const CorridorCourse& course = corridors_[newcomer.corridor].course;
  const double expected = corridors_[newcomer.corridor].lines.front() - newcomer.to_line;
  driven.approach = approach_to(corridors_[driven.corridor], v, expected);
  if (driven.approach.is_notable()) {
    // Beside its path the vehicle drives a little faster or slower than along it.
    Vehicle body = type.body;
    const double beside = driven.approach.ground_acceleration(
        corridors_.library().path(corridors_[driven.corridor].path), v.speed);
    const double left = 1.0 - beside / std::min(body.max_accel, body.max_decel);
    // In steps, so that vehicles share corridors.
    const double share = std::clamp(std::floor(left * 10.0) / 10.0, kLeastShare, kApproachReserve);
    body.max_accel *= share;
    body.max_decel *= share;
    driven.corridor = corridors_.corridor_for(course, body);
  }
  const Corridor& c = corridors_[driven.corridor];

  std::vector<double> limits = c.lateral_limits;
  for (std::size_t i = 0; i < limits.size(); ++i) {
    limits[i] = std::min({limits[i], v.speed_factor * c.lane_limits[i], type.body.max_speed});
  }
  RoadVehicle& road = driven.road;
  road.key = driven.key;
  road.stuck = v.speed == 0.0 && is_impatient(v.id);
  road.path = c.path;
  road.now = {driven.approach.begin(), v.speed * c.ratios[c.piece_at(expected)]};
  road.cruise_speed = std::min(v.speed_factor * c.lane_limits.back(), type.body.max_speed);
  road.envelope = std::make_shared<SpeedEnvelope>(std::move(limits), envelope_braking(type.body));
  road.min_gap = type.min_gap;
  road.tau = type.tau;
  road.stop_lines = c.stops;
  const ExitRoot root = predictor_.exit_root(c.course.pieces.front().lane);
  if (root.lane != LaneGraph::kNone) {
    road.entry_lane = root.lane;
    road.s_entry_lane = c.stations.front() - root.offset;
  }
  road.exit_lane = c.exit_lane;
  road.s_exit_lane = c.s_exit;
  road.s_handback = c.s_handback;
  road.s_end = c.s_end;
  return driven;
}

RoadScene Coordinator::scene() const {
  RoadScene scene{.library = &corridors_.library(), .grid = grid_, .step = step_};
  for (const auto& [id, driven] : driven_) scene.vehicles.push_back(driven.road);
  std::ranges::sort(scene.vehicles, {}, &RoadVehicle::key);
  scene.forecasts = forecasts_;
  return scene;
}

/// What everybody does who is not under control, of those near somebody who is. The guest, if there
/// is one, goes over the junction.
std::vector<Forecast> Coordinator::predict_others(
    const std::map<std::string, const Driven*>& present, const std::vector<std::string>& guests) {
  constexpr double kSight = 150.0;  // [m] around those under control in which others matter
  std::vector<Point> places;
  for (const auto& [id, driven] : present) {
    const Pose& pose = find_state(id)->pose;
    places.push_back({pose.x, pose.y});
  }
  std::vector<Forecast> forecasts;
  for (const VehicleState& v : traffic_.vehicles()) {
    const int lane = graph_.find_lane(v.lane);
    if (lane == LaneGraph::kNone || !predictor_.watches(lane) || present.contains(v.id)) continue;
    const bool near = std::ranges::any_of(places, [&](const Point& p) {
      return std::abs(p.x - v.pose.x) < kSight && std::abs(p.y - v.pose.y) < kSight;
    });
    if (!near) continue;
    for (Forecast& forecast : predict_one(v, guests)) forecasts.push_back(std::move(forecast));
  }
  return forecasts;
}

std::vector<Forecast> Coordinator::predict_one(const VehicleState& v,
                                               const std::vector<std::string>& guests) {
  const bool is_let_pass = std::ranges::count(guests, v.id) > 0;
  if (const Forecast* passage = humans_ ? humans_->passage(v.id) : nullptr;
      passage != nullptr && (is_let_pass || humans_->passes(v.id))) {
    return {*passage};
  }
  const std::vector<int> route = route_of(v);
  const bool passes = gate_.passes(v.id) || is_let_pass;
  return predictor_.predict(v, query_for(v, route), type_of(v.type).body,
                            passes ? Intent::kPasses : Intent::kWaits, time_at_stop(v), grid_,
                            step_);
}

/// How long a vehicle still stands at a scheduled stop [s].
double Coordinator::time_at_stop(const VehicleState& v) const {
  constexpr double kBoarding = 5.0;  // [s] at least: stops last longer than they are planned to
  if (!v.halted_by_stop) return 0.0;
  const std::optional<Stop> stop = traffic_.next_stop(v.id);
  if (!stop) return kBoarding;
  return std::max({kBoarding, stop->duration, stop->until - traffic_.time()});
}

bool Coordinator::planner_is_dead() const {
  return options_.replan_budget_ms <= 0.0 && traffic_.time() >= options_.budget_from;
}

/// Without a plan nobody may enter: newcomers stop before the line while vehicles are under
/// control; after that the junction is left to the traffic's own right of way.
void Coordinator::hold_back(const std::vector<Newcomer>& newcomers) {
  if (humans_) humans_->release_all();
  if (driven_.empty()) return gate_.release_all();
  for (const Newcomer& n : newcomers) gate_.hold(n.state->id);
}

/// Between two decisions: whoever enters the network right at a coordinated line waits there for
/// the next.
void Coordinator::hold_departures() {
  constexpr double kAtLine = 20.0;  // [m]
  if (planner_is_dead()) return;
  for (const VehicleState& v : traffic_.vehicles()) {
    if (trails_.contains(v.id)) continue;
    const int lane = graph_.find_lane(v.lane);
    if (lane == LaneGraph::kNone || !finder_.may_approach(lane, v.lane_position)) continue;
    const std::vector<int> route = route_of(v);
    const CourseQuery query = query_for(v, route);
    const std::optional<double> to_line = finder_.distance_to_line(query);
    if (owns_signals() && humans_->decides_for(query)) continue;  // its light is red
    if (to_line && *to_line < kAtLine) see_guest(v, query);
  }
}

/// Has it appeared, or changed lanes, since the last decision?
bool Coordinator::is_surprise(const VehicleState& v) const {
  if (driven_.contains(v.id)) return false;
  const int lane = graph_.find_lane(v.lane);
  if (lane == LaneGraph::kNone || !predictor_.watches(lane)) return false;
  const auto trail = trails_.find(v.id);
  if (trail == trails_.end()) return true;
  const int before = trail->second.lane;
  return before != LaneGraph::kNone && before != lane && graph_.edge_of(lane) != LaneGraph::kNone &&
         graph_.edge_of(before) == graph_.edge_of(lane);
}

/// Between two decisions nobody is planned for, but whoever has somebody appear right before it
/// brakes at once, and those who would run into it with it.
void Coordinator::brake_for_surprises() {
  if (planner_is_dead() || driven_.empty()) return;
  for (const VehicleState& v : traffic_.vehicles()) {
    if (is_surprise(v)) brake_for(v);
  }
}

void Coordinator::brake_for(const VehicleState& v) {
  constexpr double kNear = 60.0;  // [m]
  RoadScene now{.library = &corridors_.library(), .grid = grid_, .step = step_};
  for (const auto& [id, driven] : driven_) {
    const Pose& pose = find_state(id)->pose;
    if (distance(pose, v.pose) < kNear) now.vehicles.push_back(driven.road);
  }
  if (now.vehicles.empty()) return;
  std::ranges::sort(now.vehicles, {}, &RoadVehicle::key);
  const std::vector<int> route = route_of(v);
  now.forecasts = predictor_.predict(v, query_for(v, route), type_of(v.type).body, Intent::kWaits,
                                     time_at_stop(v), grid_, step_);
  prepare_tables(now);
  for (const std::int64_t key : who_must_brake(now, plan_, options_.escot.crossing.trajectory)) {
    const RoadVehicle& braking = now.vehicle(key);
    const double b = now.body(braking).max_decel;
    const auto entry = std::ranges::find(plan_.entries, key, &JointPlan::Entry::key);
    entry->trajectory = std::make_shared<PathTrajectory>(stop_after(now, braking.now, -b, b));
  }
}

void Coordinator::place_all() {
  for (const auto& [id, driven] : driven_) {
    const InertialState next = state_at(*plan_.find(driven.key), step_ + 1);
    const Corridor& corridor = corridors_[driven.corridor];
    const double speed = next.v / corridor.ratios[corridor.piece_at(next.s)];
    traffic_.place(id, driven.approach.pose(path_of(driven), next.s), speed);
  }
}

const GuidePath& Coordinator::path_of(const Driven& driven) const {
  return corridors_.library().path(corridors_[driven.corridor].path);
}

const VehicleState* Coordinator::find_state(const std::string& id) const {
  const std::span<const VehicleState> states = traffic_.vehicles();
  const auto state = std::ranges::lower_bound(states, id, {}, &VehicleState::id);
  return state != states.end() && state->id == id ? &*state : nullptr;
}

const VehicleType& Coordinator::type_of(const std::string& id) {
  const auto known = types_.find(id);
  return known != types_.end() ? known->second
                               : types_.emplace(id, traffic_.type(id)).first->second;
}

}  // namespace mvtp
