// How a coordinator finds the plan to be accepted: which arrivals and which guests are in it.

#include <algorithm>
#include <cmath>

#include "coordinator/drivers/human_drivers.hpp"
#include "coordinator/junctions/coordinator.hpp"
#include "coordinator/junctions/referee.hpp"

namespace mvtp {

/// The plan with all arrivals but those that come too late, that get no complete plan, or one that
/// the referee refuses; with guests that go over junctions too, where that leaves nobody without a
/// plan.
Coordinator::Trial Coordinator::best_trial(const std::map<std::string, Driven>& arrivals,
                                           const std::vector<std::int64_t>& upset) {
  const std::set<std::string> excluded = too_late(arrivals);
  using Groups = std::vector<std::vector<std::string>>;
  const Groups groups = groups_of_guests();
  // Where everybody is taken over mostly all can go, and nobody asks what it costs.
  const Groups offers = heads_ ? Groups() : in_order(groups);
  std::optional<Trial> all;
  if (!offers.empty()) {
    all = plan_trial(arrivals, excluded, upset, offers.front());
    const bool nobody_loses =
        all->decision.stepped == 0 && all->refused.empty() && !waits_inside(*all);
    if (nobody_loses && !touches_guests(all->guests, *all)) return *std::move(all);
  }
  return best_trial_by_zones(arrivals, excluded, upset, groups, std::move(all));
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
    const bool has_plan =
        trial.decision.plan.find(arrival.key)->complete || !options_.escot.plans_groups;
    if ((refused && (whole_groups || touching.contains(arrival.key))) ||
        (!has_plan && may_come_later(id, arrival))) {
      later.insert(id);
    }
  }
  return later;
}

namespace {

/// The circle around all places where the body may be while it brakes to rest.
Circle braking_area(const PathLibrary& library, const RoadVehicle& v) {
  const Vehicle& body = library.body(v.path);
  const double reach = std::hypot(std::max(body.front, body.rear), body.width / 2.0);
  const Pose pose = library.path(v.path).at(v.now.s);
  return {pose.x, pose.y, stopping_distance(v.now.v, body.max_decel) + reach};
}

/// May the two touch while both brake?
bool stop_near_each_other(const PathLibrary& library, const RoadVehicle& a, const RoadVehicle& b) {
  constexpr double kMargins = 2.0;  // [m], more than any
  const Circle area_a = braking_area(library, a);
  const Circle area_b = braking_area(library, b);
  return std::hypot(area_b.x - area_a.x, area_b.y - area_a.y) <
         area_a.radius + area_b.radius + kMargins;
}

}  // namespace

/// Arrivals whose new paths lead into somebody, however hard they brake: those are better off as
/// they are. So are the others until they are admitted.
std::set<std::string> Coordinator::too_late(const std::map<std::string, Driven>& arrivals) {
  std::set<std::string> late;
  if (arrivals.empty()) return late;
  RoadScene now = empty_scene();
  std::map<std::string, const Driven*> present;
  for (const auto& [id, driven] : driven_) {
    present[id] = &driven;
    now.vehicles.push_back(driven.road);
  }
  std::map<std::int64_t, std::string> in_order;
  std::map<std::string, std::vector<Forecast>> with_drivers;
  for (const auto& [id, arrival] : arrivals) {
    in_order.emplace(arrival.key, id);
    if (!driven_.contains(id)) {
      with_drivers[id] = predict_one(*find_state(id), {});
      look_ahead(with_drivers[id]);
    }
    present[id] = &arrival;
  }
  now.forecasts = predict_others(present, {});
  for (const auto& [key, id] : in_order) {
    const RoadVehicle& road = arrivals.at(id).road;
    const auto runs_into = [&](const RoadVehicle& other) {
      return other.key != road.key && stop_near_each_other(corridors_.library(), road, other) &&
             RoadContact(now, road, other, 0.0).braking_is_too_late();
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

/// A newcomer waits at its line; one that goes on from another corridor must still be able to stop
/// there after this decision, if need be as hard as it can.
bool Coordinator::may_come_later(const std::string& id, const Driven& arrival) const {
  if (!driven_.contains(id)) return true;
  constexpr double kSpare = 5.0;  // [m] before the line
  const InertialState& now = arrival.road.now;
  const double to_line = corridors_[arrival.corridor].lines.front() - now.s;
  const double b = corridors_.library().body(arrival.road.path).max_decel;
  return to_line >= now.v * grid_.decision() + stopping_distance(now.v, b) + kSpare;
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
  RoadScene now = empty_scene();
  for (const auto& [id, driven] : present) {
    now.vehicles.push_back(driven->road);
    trial.paths.emplace(driven->key, driven->road.path);
    trial.zones.emplace(driven->key, zone_of(driven->corridor));
  }
  std::ranges::sort(now.vehicles, {}, &RoadVehicle::key);
  now.forecasts = trial.forecasts = predict_others(present, guests);
  prepare_tables(now);
  // The plans that vehicles follow to the end of their corridors.
  JointPlan incumbent = plan_;
  std::erase_if(incumbent.entries, [&](const auto& e) {
    return !e.profile->complete || arriving.contains(e.key) || std::ranges::count(upset, e.key) > 0;
  });
  trial.decision = decide_on_road(now, incumbent, without_plan(now, incumbent, upset), escot());
  left_without_plan_ = trial.decision.stepped > 0;
  trial.contacts =
      find_planned_contacts(now, trial.decision.plan, plan_touches_ ? JointPlan() : plan_);
  trial.refused = groups_in_contact(trial.decision.members, trial.contacts);
  return trial;
}

/// Groups whose vehicles would touch, and do better with their old plans, on their old corridors.
std::vector<std::size_t> Coordinator::better_with_old_plans(
    const Trial& trial, const std::map<std::string, Driven>& arrivals) const {
  if (trial.refused.empty()) return {};
  RoadScene now = empty_scene();
  RoadScene before = empty_scene();
  JointPlan old_plan;
  for (const auto& [id, driven] : driven_) {
    if (!trial.paths.contains(driven.key)) continue;
    if (const JointPlan::Entry* entry = plan_.entry(driven.key)) {
      before.vehicles.push_back(driven.road);
      old_plan.entries.push_back(*entry);
    }
    const auto arrival = arrivals.find(id);
    const bool goes_on = arrival != arrivals.end() && !trial.excluded.contains(id);
    now.vehicles.push_back(goes_on ? arrival->second.road : driven.road);
  }
  for (const auto& [id, arrival] : arrivals) {
    if (driven_.contains(id) || trial.excluded.contains(id)) continue;
    now.vehicles.push_back(arrival.road);
  }
  for (RoadScene* scene : {&now, &before}) {
    std::ranges::sort(scene->vehicles, {}, &RoadVehicle::key);
  }
  return better_as_before(trial.decision.members, find_planned_contacts(now, trial.decision.plan),
                          find_planned_contacts(before, old_plan));
}

/// Contact tables of all paths in use, before threads look into them.
void Coordinator::prepare_tables(const RoadScene& now) {
  std::vector<int> paths;
  std::vector<int> others;
  for (const RoadVehicle& v : now.vehicles) paths.push_back(v.path);
  for (const Forecast& f : now.forecasts) others.push_back(f.vehicle.path);
  corridors_.library().build_tables(paths, others);
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

}  // namespace mvtp
