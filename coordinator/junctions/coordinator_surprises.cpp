// Between two decisions, and without a planner: who is held, and who brakes for whom.

#include <algorithm>

#include "coordinator/drivers/human_drivers.hpp"
#include "coordinator/junctions/coordinator.hpp"
#include "planner/road.hpp"

namespace mvtp {

/// Without a plan nobody may enter: newcomers stop before the line, and no light turns green, while
/// vehicles are under control, which keep their plans but still brake for whoever blocks them;
/// after that the junction is left to the traffic's own right of way, or its signal's own program.
void Coordinator::hold_back(const std::vector<Newcomer>& newcomers) {
  if (driven_.empty()) {
    if (humans_) humans_->release_all();
    if (people_) people_->release_all();
    if (heads_) heads_->free();
    return gate_.release_all();
  }
  for (const Newcomer& n : newcomers) gate_.hold(n.state->id);
  for (const VehicleState& v : traffic_.vehicles()) {
    const int lane = graph_.find_lane(v.lane);
    const bool matters = lane != LaneGraph::kNone && predictor_.watches(lane);
    if (matters && !driven_.contains(v.id)) brake_for(v);
  }
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
    if (greens_ && greens_->governs(query)) continue;             // it has a light
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
  RoadScene now = empty_scene();
  for (const auto& [id, driven] : driven_) {
    const Pose& pose = find_state(id)->pose;
    if (distance(pose, v.pose) < kNear) now.vehicles.push_back(driven.road);
  }
  if (now.vehicles.empty()) return;
  std::ranges::sort(now.vehicles, {}, &RoadVehicle::key);
  now.forecasts = predict_one(v, {});
  look_ahead(now.forecasts);
  prepare_tables(now);
  for (const std::int64_t key : who_must_brake(now, plan_, options_.escot.crossing.profile)) {
    const RoadVehicle& braking = now.vehicle(key);
    const double b = now.body(braking).max_decel;
    plan_.entry(key)->profile = std::make_shared<SpeedProfile>(stop_after(now, braking.now, -b, b));
  }
  commit({});
}

}  // namespace mvtp
