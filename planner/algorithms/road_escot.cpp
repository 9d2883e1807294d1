#include "planner/algorithms/road_escot.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "planner/algorithms/pbcr.hpp"

namespace mvtp {
namespace {

constexpr double kBrakingSample = 0.1;  ///< [s]

bool may_meet(const RoadScene& scene, const RoadVehicle& a, const RoadVehicle& b) {
  return (a.exit_lane >= 0 && a.exit_lane == b.exit_lane) ||
         scene.library->contacts(a.path, b.path).relevant(a.now.s, a.s_end, b.now.s);
}

/// Position `t` seconds into a motion: the decision, then braking to rest.
double position(const RoadStepWorld::Motion& m, double b, double decision, double t) {
  return t <= decision ? advance(m.from, m.acceleration, t).s
                       : braked_position(m.to, b, t - decision);
}

/// The motion that a trajectory makes during the decision of now.
RoadStepWorld::Motion first_motion(const RoadScene& scene, const PathTrajectory& trajectory) {
  const InertialState from = trajectory.at(scene.step);
  const InertialState to = trajectory.at(scene.step + scene.grid.steps_per_decision);
  return {from, held_acceleration(from, to, scene.grid.decision()), to};
}

/// The decision of `motion`, and braking to rest after it: safe, but not complete.
PathTrajectory stop_after(const RoadScene& scene, const RoadStepWorld::Motion& motion, double b) {
  PathTrajectory t{.begin = scene.step, .states = {}, .complete = false};
  const int n = scene.grid.steps_per_decision;
  for (int i = 0; i <= n; ++i) {
    t.states.push_back(advance(motion.from, motion.acceleration, i * scene.grid.dt));
  }
  for (int i = 1; t.states.back().v > 0.0; ++i) {
    t.states.push_back(advance(motion.to, -b, i * scene.grid.dt));
  }
  return t;
}

/// PBCR for the vehicles without a complete plan; the others are decided, unless that is
/// impossible.
void step_the_rest(const RoadScene& scene, RoadDecision& decision,
                   const RoadEscotOptions& options) {
  const JointPlan complete = decision.plan;
  const RoadStepWorld world(scene, complete, options.crossing.trajectory);
  std::vector<InertialState> from;
  std::vector<std::optional<RoadStepWorld::Motion>> decided;
  for (const RoadVehicle& v : scene.vehicles) {
    from.push_back(v.now);
    const PathTrajectory* t = complete.find(v.key);
    decided.push_back(t ? std::optional(first_motion(scene, *t)) : std::nullopt);
  }
  std::vector<int> order(from.size());
  std::iota(order.begin(), order.end(), 0);  // the longest in the zone first

  const Pbcr<RoadStepWorld> pbcr(world);
  auto motions = pbcr.step(from, order, decided);
  decision.all_stepped = !motions.has_value();
  if (!motions) {
    motions = pbcr.step(from, order);
    decision.plan.entries.clear();
  }
  for (std::size_t i = 0; i < from.size(); ++i) {
    const RoadVehicle& v = scene.vehicles[i];
    if (decision.plan.find(v.key)) continue;
    ++decision.stepped;
    decision.plan.entries.push_back({v.key, std::make_shared<PathTrajectory>(stop_after(
                                                scene, (*motions)[i], scene.body(v).max_decel))});
  }
}

}  // namespace

std::vector<std::vector<std::int64_t>> group_vehicles(const RoadScene& scene) {
  const auto& vehicles = scene.vehicles;
  std::vector<std::vector<std::int64_t>> groups;
  std::vector<bool> grouped(vehicles.size(), false);
  for (std::size_t first = 0; first < vehicles.size(); ++first) {
    if (grouped[first]) continue;
    std::vector<std::size_t> members = {first};
    grouped[first] = true;
    for (std::size_t m = 0; m < members.size(); ++m) {
      for (std::size_t j = 0; j < vehicles.size(); ++j) {
        const RoadVehicle& a = vehicles[members[m]];
        if (grouped[j] || !(may_meet(scene, a, vehicles[j]) || may_meet(scene, vehicles[j], a))) {
          continue;
        }
        grouped[j] = true;
        members.push_back(j);
      }
    }
    std::ranges::sort(members);
    auto& group = groups.emplace_back();
    for (const std::size_t m : members) group.push_back(vehicles[m].key);
  }
  return groups;
}

RoadDecision decide_on_road(const RoadScene& scene, const JointPlan& incumbent,
                            const std::vector<std::int64_t>& order,
                            const RoadEscotOptions& options) {
  RoadDecision decision;
  for (const std::vector<std::int64_t>& group : group_vehicles(scene)) {  // Alg. 2, lines 12-17
    ++decision.groups;
    std::vector<std::int64_t> keys;
    for (const std::int64_t key : group) {
      if (incumbent.find(key)) keys.push_back(key);
    }
    const bool pre_check = int(group.size()) <= options.max_group;
    for (const std::int64_t key : order) {
      if (pre_check && std::ranges::binary_search(group, key)) keys.push_back(key);
    }
    CrossingOptions crossing = options.crossing;
    if (!pre_check) crossing.tries = 0;
    const std::uint64_t seed = options.seed + std::uint64_t(scene.step) * 1000003U;
    CrossingResult result = plan_crossing(scene, keys, incumbent, crossing, seed);
    decision.cost += result.cost;
    for (JointPlan::Entry& e : result.plan.entries) decision.plan.entries.push_back(std::move(e));
  }
  const bool all_planned = decision.plan.entries.size() == scene.vehicles.size();
  if (!all_planned) step_the_rest(scene, decision, options);  // lines 18-21
  return decision;
}

std::vector<RoadStepWorld::Motion> RoadStepWorld::candidates(int i, const State& state) const {
  const RoadVehicle& v = vehicle(i);
  const Vehicle& body = scene_.body(v);
  const double h = scene_.grid.decision();
  const WaitTest wait(scene_, v, complete_.entries, options_);
  std::vector<Motion> clear;
  std::vector<Motion> blocking;
  for (const double a :
       {body.max_accel, 0.5 * body.max_accel, 0.0, -0.5 * body.max_decel, -body.max_decel}) {
    const Motion m{state, a, advance(state, a, h)};
    if (a > -body.max_decel && m.to.v > v.envelope->at(m.to.s)) continue;
    if (a > -body.max_decel && !wait.clear_of_forecasts(state, a, m.to)) continue;
    const bool keeps_clear = wait.can_wait(scene_.step + scene_.grid.steps_per_decision, m.to);
    (keeps_clear ? clear : blocking).push_back(m);
  }
  clear.insert(clear.end(), blocking.begin(), blocking.end());
  return clear;
}

RoadStepWorld::Motion RoadStepWorld::safe_stop(int i, const State& state) const {
  const double b = scene_.body(vehicle(i)).max_decel;
  return {state, -b, advance(state, -b, scene_.grid.decision())};
}

bool RoadStepWorld::conflict(int i, const Motion& a, int j, const Motion& b) const {
  if (i > j) return conflict(j, b, i, a);  // one table per pair: symmetric to the last bit
  const ContactTable& contacts = scene_.library->contacts(vehicle(i).path, vehicle(j).path);
  const double brake_a = scene_.body(vehicle(i)).max_decel;
  const double brake_b = scene_.body(vehicle(j)).max_decel;
  const double reach = a.to.s + stopping_distance(a.to.v, brake_a);
  if (!contacts.relevant(a.from.s, reach, b.from.s)) return false;
  const double h = scene_.grid.decision();
  const double rest = h + std::max(a.to.v / brake_a, b.to.v / brake_b);
  for (double t = kBrakingSample; t < rest + kBrakingSample; t += kBrakingSample) {
    if (contacts.touches(position(a, brake_a, h, t), position(b, brake_b, h, t))) return true;
  }
  return false;
}

}  // namespace mvtp
