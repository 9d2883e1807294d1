#include "coordinator/coordinator.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>

#include "coordinator/referee.hpp"

namespace mvtp {
namespace {

constexpr int kRefereeSteps = 2;  ///< of the simulation between two looks at a new plan
constexpr double kBlend = 20.0;  ///< [m] over which the offset at takeover disappears

/// Comfortable braking towards lower speed limits.
double envelope_braking(const Vehicle& body) { return std::min(3.5, 0.8 * body.max_decel); }

double smoothstep(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3.0 - 2.0 * x);
}

/// A leader: holds its speed for three seconds, then speeds up gently. Predicting that a standing
/// leader stands for ever would leave the vehicles behind it without any complete plan.
PathTrajectory predict_leader(const RoadVehicle& v, const DecisionGrid& grid, std::int64_t step) {
  constexpr double kHold = 3.0;
  constexpr double kAcceleration = 1.0;
  PathTrajectory t{.begin = step, .states = {v.now}};
  while (t.states.back().s < v.s_end && t.states.size() < 3000) {
    const InertialState last = t.states.back();
    const bool holds = double(t.states.size()) * grid.dt <= kHold || last.v >= v.cruise_speed;
    t.states.push_back(advance(last, holds ? 0.0 : kAcceleration, grid.dt));
  }
  return t;
}

/// A vehicle in a wrong lane: halts at the line, and has found a way into its lane after a while.
PathTrajectory predict_halt(const RoadVehicle& v, const DecisionGrid& grid, std::int64_t step) {
  constexpr double kBraking = 3.0;
  constexpr double kStand = 8.0;
  PathTrajectory t{.begin = step, .states = {v.now}};
  double stood = 0.0;
  while (stood < kStand) {
    const InertialState last = t.states.back();
    const double room = v.s_entry_line - 1.0 - last.s - last.v * grid.dt;
    const bool brakes = room <= stopping_distance(last.v, kBraking);
    t.states.push_back(advance(last, brakes ? -kBraking : 0.0, grid.dt));
    stood += t.states.back().v == 0.0 || t.states.size() > 600 ? grid.dt : 0.0;
  }
  return t;
}

}  // namespace

Coordinator::Coordinator(Traffic& traffic, Zone& zone, const CoordinatorOptions& options)
    : traffic_(traffic), zone_(zone), options_(options) {
  grid_.dt = traffic.step_length();
  grid_.steps_per_decision = std::max(1, int(std::lround(options.decision / grid_.dt)));
}

void Coordinator::prepare() {
  for (const std::string& type : traffic_.types()) {
    for (const auto& [id, junction] : traffic_.network().junctions) {
      for (const Connection& c : junction.connections) {
        const Lane& from = traffic_.network().lanes.at(c.from_lane);
        const Lane& to = traffic_.network().lanes.at(c.to_lane);
        const VehicleState waiting{.type = type, .lane = from.id, .lane_position = from.length};
        const std::vector<std::string> route = {from.edge, to.edge};
        if (from.drivable && to.drivable) (void)zone_.movement_for(waiting, route, type_of(type));
      }
    }
  }
  const PathLibrary& library = zone_.library();
  for (int a = 0; a < library.size(); ++a) {
    for (int b = 0; b < library.size(); ++b) (void)library.contacts(a, b);
  }
}

void Coordinator::decide() {
  taken_over_.clear();
  handed_back_.clear();
  if (step_ % grid_.steps_per_decision == 0) replan();
}

void Coordinator::act() {
  place_all();
  ++step_;
}

void Coordinator::replan() {
  hand_back_the_finished();
  const std::vector<Newcomer> newcomers = find_newcomers();
  if (planner_is_dead()) return hold_back(newcomers);
  if (newcomers.empty() && driven_.empty()) return;

  const auto begin = std::chrono::steady_clock::now();
  forecasts_ = predict_others(newcomers);
  std::map<std::string, Driven> admitted;
  for (const Newcomer& n : newcomers) admitted.emplace(n.state->id, admit(n));
  std::vector<std::int64_t> order;
  for (const auto& [id, driven] : admitted) order.push_back(driven.key);
  std::ranges::sort(order);  // keys are given in the order of arrival
  driven_.insert(admitted.begin(), admitted.end());

  RoadEscotOptions escot = options_.escot;
  JointPlan incumbent = plan_;
  std::erase_if(incumbent.entries, [](const auto& e) { return !e.trajectory->complete; });
  const RoadScene now = scene();
  for (const RoadVehicle& v : now.vehicles) {
    if (plan_.find(v.key) && !incumbent.find(v.key)) order.push_back(v.key);
  }
  if (stalled()) {  // a duplicate configuration [ESCoT, Alg. 2 l. 4-6]: another order, at random
    incumbent.entries.clear();
    order.clear();
    for (const RoadVehicle& v : now.vehicles) order.push_back(v.key);
    std::mt19937_64 random(escot.seed + std::uint64_t(step_));
    std::ranges::shuffle(order, random);
  }
  RoadDecision decision = decide_on_road(now, incumbent, order, escot);
  const bool refused = find_planned_contact(now, decision.plan, kRefereeSteps).has_value();

  Replan record{.time = traffic_.time(),
                .vehicles = int(now.vehicles.size()),
                .newcomers = int(newcomers.size()),
                .forecasts = int(forecasts_.size()),
                .groups = decision.groups,
                .stepped = decision.stepped,
                .cost = decision.cost};
  record.ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  const bool late =
      traffic_.time() >= options_.budget_from && record.ms > options_.replan_budget_ms;
  record.fallback = late || refused;
  replans_.push_back(record);
  if (record.fallback) {
    for (const auto& [id, driven] : admitted) driven_.erase(id);
    return hold_back(newcomers);
  }
  plan_ = std::move(decision.plan);
  for (const auto& [id, driven] : admitted) {
    if (held_.erase(id) > 0) traffic_.hold(id, false);
    traffic_.take_over(id);
    taken_over_.push_back(id);
  }
}

void Coordinator::hand_back_the_finished() {
  std::vector<std::string> finished;
  for (auto& [id, driven] : driven_) {
    driven.road.now = plan_.find(driven.key)->at(step_);
    if (driven.road.now.s >= driven.road.s_handback) finished.push_back(id);
  }
  for (const std::string& id : finished) {
    traffic_.hand_back(id);
    handed_back_.push_back(id);
    last_movement_[id] = driven_.at(id).movement;
    const std::int64_t key = driven_.at(id).key;
    std::erase_if(plan_.entries, [key](const auto& e) { return e.key == key; });
    driven_.erase(id);
  }
}

std::vector<Coordinator::Newcomer> Coordinator::find_newcomers() {
  std::vector<Newcomer> newcomers;
  for (const VehicleState& v : traffic_.vehicles()) {
    if (driven_.contains(v.id) || !zone_.is_approaching(v)) continue;
    const auto movement = zone_.movement_for(v, traffic_.route(v.id), type_of(v.type));
    if (movement) {
      newcomers.push_back({&v, *movement});
    } else if (traffic_.route(v.id).size() > 1) {
      ++wrong_lane_sightings_;
    }
  }
  // Whoever is nearer to the line has arrived earlier; lanes keep their order this way.
  const auto to_line = [&](const Newcomer& n) {
    return traffic_.network().lanes.at(n.state->lane).length - n.state->lane_position;
  };
  std::ranges::stable_sort(newcomers, {}, to_line);
  return newcomers;
}

Driven Coordinator::admit(const Newcomer& newcomer) {
  const VehicleState& v = *newcomer.state;
  const VehicleType& type = type_of(v.type);
  const Movement& m = zone_.movement(newcomer.movement);
  const GuidePath& path = zone_.library().path(m.path);
  Driven driven{.key = next_key_++, .movement = newcomer.movement};

  const double expected = m.lane_starts.at(v.lane) + v.lane_position;
  driven.s_taken = path.project({v.pose.x, v.pose.y}, expected - 3.0, expected + 3.0);
  driven.offset = relative(path.at(driven.s_taken), v.pose);
  driven.offset.x = 0.0;

  std::vector<double> limits = m.lateral_limits;
  for (std::size_t i = 0; i < limits.size(); ++i) {
    limits[i] = std::min({limits[i], v.speed_factor * m.lane_limits[i], type.body.max_speed});
  }
  RoadVehicle& road = driven.road;
  road.key = driven.key;
  road.path = m.path;
  road.now = {driven.s_taken, v.speed};
  road.cruise_speed = std::min(v.speed_factor * m.lane_limits.back(), type.body.max_speed);
  road.envelope = std::make_shared<SpeedEnvelope>(std::move(limits), envelope_braking(type.body));
  road.min_gap = type.min_gap;
  road.tau = type.tau;
  road.entry_lane = m.entry_lane;
  road.s_entry_line = m.s_entry_line;
  road.exit_lane = m.exit_lane;
  road.s_exit_lane = m.s_exit_lane;
  road.s_handback = m.s_handback;
  road.s_end = m.s_end;
  return driven;
}

RoadScene Coordinator::scene() const {
  RoadScene scene{.library = &zone_.library(), .grid = grid_, .step = step_};
  for (const auto& [id, driven] : driven_) scene.vehicles.push_back(driven.road);
  std::ranges::sort(scene.vehicles, {}, &RoadVehicle::key);
  scene.forecasts = forecasts_;
  return scene;
}

std::vector<Forecast> Coordinator::predict_others(const std::vector<Newcomer>& newcomers) {
  std::set<std::string> ours;
  for (const Newcomer& n : newcomers) ours.insert(n.state->id);
  std::vector<Forecast> forecasts;
  for (const VehicleState& v : traffic_.vehicles()) {
    if (driven_.contains(v.id) || ours.contains(v.id)) continue;
    if (auto forecast = predict(v)) {
      forecasts.push_back(std::move(*forecast));
    } else {
      last_movement_.erase(v.id);
    }
  }
  return forecasts;
}

std::optional<Forecast> Coordinator::predict(const VehicleState& v) {
  if (!zone_.touches(v.lane)) return std::nullopt;
  const auto known = last_movement_.find(v.id);
  std::optional<int> number;
  if (known != last_movement_.end() && zone_.movement(known->second).lane_starts.contains(v.lane)) {
    number = known->second;
  } else {
    number = zone_.movement_over(v.lane, type_of(v.type));
  }
  if (!number) return std::nullopt;
  const Movement& m = zone_.movement(*number);
  // On the approach everybody is a newcomer sooner or later, but for those in a wrong lane.
  const bool before_line = v.lane == m.lanes[0];
  if (before_line && !zone_.is_approaching(v)) return std::nullopt;

  const GuidePath& path = zone_.library().path(m.path);
  const double expected = m.lane_starts.at(v.lane) + v.lane_position;
  Forecast forecast;
  RoadVehicle& road = forecast.vehicle;
  road.key = -1;
  road.path = m.path;
  road.now = {path.project({v.pose.x, v.pose.y}, expected - 3.0, expected + 3.0), v.speed};
  road.cruise_speed =
      std::min(v.speed_factor * m.lane_limits.back(), type_of(v.type).body.max_speed);
  road.s_entry_line = m.s_entry_line;
  road.exit_lane = m.exit_lane;
  road.s_exit_lane = m.s_exit_lane;
  road.s_handback = m.s_handback;
  road.s_end = path.length();
  if (road.now.s >= road.s_end) return std::nullopt;
  forecast.trajectory =
      before_line ? predict_halt(road, grid_, step_) : predict_leader(road, grid_, step_);
  return forecast;
}

/// Has nothing moved since the last decision, though everybody is there to get away?
bool Coordinator::stalled() {
  std::vector<InertialState> configuration;
  for (const auto& [id, driven] : driven_) configuration.push_back(driven.road.now);
  const bool all_stand =
      std::ranges::all_of(configuration, [](const auto& x) { return x.v == 0.0; });
  const bool same = all_stand && configuration == last_configuration_;
  last_configuration_ = std::move(configuration);
  return same;
}

bool Coordinator::planner_is_dead() const {
  return options_.replan_budget_ms <= 0.0 && traffic_.time() >= options_.budget_from;
}

/// Without a plan nobody may enter: newcomers stop before the line while vehicles are under
/// control; after that the junction is left to the traffic's own right of way.
void Coordinator::hold_back(const std::vector<Newcomer>& newcomers) {
  if (driven_.empty()) {
    for (const std::string& id : held_) traffic_.hold(id, false);
    held_.clear();
    return;
  }
  for (const Newcomer& n : newcomers) {
    if (held_.insert(n.state->id).second) traffic_.hold(n.state->id, true);
  }
}

void Coordinator::place_all() {
  for (const auto& [id, driven] : driven_) {
    const Movement& m = zone_.movement(driven.movement);
    const InertialState next = plan_.find(driven.key)->at(step_ + 1);
    const double left = 1.0 - smoothstep((next.s - driven.s_taken) / kBlend);
    const Pose aside{0.0, left * driven.offset.y, left * driven.offset.theta};
    traffic_.place(id, compose(zone_.library().path(m.path).at(next.s), aside), next.v);
  }
}

const VehicleType& Coordinator::type_of(const std::string& id) {
  const auto known = types_.find(id);
  return known != types_.end() ? known->second
                               : types_.emplace(id, traffic_.type(id)).first->second;
}

}  // namespace mvtp
