// What a coordinator expects of those who are not under control: drivers and people.

#include <algorithm>
#include <cmath>

#include "coordinator/drivers/human_drivers.hpp"
#include "coordinator/junctions/coordinator.hpp"
#include "coordinator/prediction/following.hpp"

namespace mvtp {

/// What everybody does who is not under control, of those near somebody who is: vehicles and
/// people. Guests go over the junction.
std::vector<Forecast> Coordinator::predict_others(
    const std::map<std::string, const Driven*>& present, const std::vector<std::string>& guests) {
  constexpr double kRange = 150.0;  // [m] around those under control in which others matter
  std::vector<Point> places;
  for (const auto& [id, driven] : present) {
    const Pose& pose = find_state(id)->pose;
    places.push_back({pose.x, pose.y});
  }
  const auto is_near = [&](const Point& where) {
    return std::ranges::any_of(places, [&](const Point& p) {
      return std::abs(p.x - where.x) < kRange && std::abs(p.y - where.y) < kRange;
    });
  };
  std::vector<Forecast> forecasts;
  for (const VehicleState& v : traffic_.vehicles()) {
    if (!is_watched(v) || present.contains(v.id)) continue;
    if (!is_near({v.pose.x, v.pose.y})) continue;
    for (Forecast& forecast : predict_one(v, guests)) forecasts.push_back(std::move(forecast));
  }
  follow_leaders(forecasts, empty_scene());
  if (people_) {
    for (People::Expected& person : people_->expect(guests)) {
      const Forecast& f = person.forecast;
      const Pose where = corridors_.library().path(f.vehicle.path).at(f.vehicle.now.s);
      if (is_near({where.x, where.y})) forecasts.push_back(std::move(person.forecast));
    }
  }
  look_ahead(forecasts);
  return forecasts;
}

std::vector<Forecast> Coordinator::predict_one(const VehicleState& v,
                                               const std::vector<std::string>& guests) {
  const bool is_let_pass = std::ranges::count(guests, v.id) > 0;
  if (humans_ && humans_->knows(v.id) && (is_let_pass || humans_->passes(v.id))) {
    std::vector<Forecast> passages = humans_->passages(v.id);
    for (Forecast& f : passages) f.is_new = !humans_->passes(v.id);
    return passages;
  }
  const std::vector<int> route = route_of(v);
  const CourseQuery query = query_for(v, route);
  const bool heeds_light = greens_ && !options_.share.contains(v.id, v.type) &&
                           !lost_.contains(v.id) && !v.halted_by_stop;
  if (heeds_light && greens_->governs(query)) {
    return greens_->expect(v, query, type_of(v.type),
                           step_ - std::int64_t(std::lround(v.age / grid_.dt)));
  }
  const bool passes = gate_.passes(v.id) || is_let_pass;
  const bool has_red = owns_signals() && humans_->knows(v.id);
  const Intent intent = lost_.contains(v.id) ? Intent::kUnknown
                        : passes             ? Intent::kPasses
                        : has_red            ? Intent::kHasRed
                                             : Intent::kWaits;
  std::vector<Forecast> forecasts =
      predictor_.predict(v, query, type_of(v.type).body, intent, stand_of(v), grid_,
                         step_ - std::int64_t(std::lround(v.age / grid_.dt)));
  const bool has_to_wait = gate_.holds(v.id) || (humans_ && humans_->has_to_wait(v.id));
  for (Forecast& f : forecasts) {
    f.told = intent == Intent::kPasses ? Told::kToPass
             : has_to_wait             ? Told::kToWait
                                       : Told::kNothing;
    f.is_new = is_let_pass && !gate_.passes(v.id);
  }
  // Mostly it is taken over as soon as it has a plan.
  if (gate_.holds_guest(v.id) || is_impatient(v.id)) return forecasts;
  for (Forecast& f : forecasts) f.held.reset();
  return forecasts;
}

/// Those who stand for longer than somebody who is about to go on.
HaltedQueues Coordinator::halted_queues() {
  constexpr double kBriefly = 3.0;  // [s]
  std::vector<HaltedDriver> halted;
  for (const VehicleState& v : traffic_.vehicles()) {
    const int lane = graph_.find_lane(v.lane);
    if (lane == LaneGraph::kNone || finder_.may_approach(lane, v.lane_position)) continue;
    if (driven_.contains(v.id)) continue;
    const Stand stand = stand_of(v);
    const double stands = std::max(stand.scheduled, stand.so_far);
    if (stands <= kBriefly) continue;
    halted.push_back(
        {lane, v.lane_position, v.lane_position - type_of(v.type).body.length(), stands});
  }
  return HaltedQueues(std::move(halted));
}

/// How long a vehicle has stood, or still stands at a scheduled stop.
Stand Coordinator::stand_of(const VehicleState& v) const {
  constexpr double kBoarding = 5.0;  // [s] at least: stops last longer than they are planned to
  const auto trail = trails_.find(v.id);
  const int decisions = trail == trails_.end() ? 0 : trail->second.stood;
  if (!v.halted_by_stop) {
    return {.so_far = decisions * grid_.decision(), .behind = straddling_.stop_position(v)};
  }
  const std::optional<Stop> stop = traffic_.next_stop(v.id);
  if (!stop) return {.scheduled = kBoarding};
  return {.scheduled = std::max({kBoarding, stop->duration, stop->until - traffic_.time()})};
}

}  // namespace mvtp
