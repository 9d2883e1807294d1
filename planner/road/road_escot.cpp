#include "planner/road/road_escot.hpp"

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "planner/escot/pbcr.hpp"

namespace mvtp {
namespace {

using Keys = std::vector<std::int64_t>;

/// What vehicles on one path with one exit lane have still before them.
struct Ahead {
  int path = 0;
  int exit_lane = -1;
  int entry_lane = -1;
  double from = 0.0;  ///< [m] rear axle
  double to = 0.0;
};

Ahead ahead_of(const RoadScene& scene, const RoadVehicle& v) {
  // A plan ends with the decision in which it reaches s_end.
  const double beyond = std::max(v.now.v, scene.body(v).max_speed) * scene.grid.decision();
  return {v.path, v.exit_lane, v.entry_lane, v.now.s, std::max(v.now.s, v.s_end) + beyond};
}

bool may_meet(const PathLibrary& library, const Ahead& a, const Ahead& b) {
  const auto follows = [](const Ahead& behind, const Ahead& before) {
    return behind.exit_lane >= 0 &&
           (behind.exit_lane == before.exit_lane || behind.exit_lane == before.entry_lane);
  };
  return follows(a, b) || follows(b, a) ||
         library.contacts(a.path, b.path).reaches(a.from, a.to, b.from, b.to);
}

/// Of all vehicles on the same path, in the order of paths; whoever may meet one vehicle on a path
/// may meet the hindmost.
std::vector<Ahead> paths_ahead(const RoadScene& scene) {
  std::map<std::pair<int, int>, Ahead> paths;
  for (const RoadVehicle& v : scene.vehicles) {
    const Ahead own = ahead_of(scene, v);
    Ahead& all = paths.try_emplace({v.path, v.exit_lane}, own).first->second;
    all.from = std::min(all.from, own.from);
    all.to = std::max(all.to, own.to);
  }
  std::vector<Ahead> list;
  for (const auto& [path, ahead] : paths) list.push_back(ahead);
  return list;
}

/// The motion that a trajectory makes during the decision of now.
RoadStepWorld::Motion first_motion(const RoadScene& scene, const PathTrajectory& trajectory) {
  const InertialState from = trajectory.at(scene.step);
  // One that leaves within the decision counts as if it drove on at the same acceleration.
  const std::int64_t last = std::min(scene.step + scene.grid.steps_per_decision,
                                     std::max(scene.step, trajectory.end() - 1));
  const InertialState to = trajectory.at(last);
  const double h = double(last - scene.step) * scene.grid.dt;
  const double a = h > 0.0 ? held_acceleration(from, to, h) : 0.0;
  return {from, a, advance(from, a, scene.grid.decision())};
}

/// PBCR for the vehicles without a complete plan; the others are decided, unless that is
/// impossible.
void step_the_rest(const RoadPairs& pairs, RoadDecision& decision,
                   const RoadEscotOptions& options) {
  const RoadScene& scene = pairs.scene();
  const JointPlan complete = decision.plan;
  const RoadStepWorld world(pairs, complete, options.crossing.trajectory);
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
    const RoadStepWorld::Motion& m = (*motions)[i];
    decision.plan.entries.push_back(
        {v.key, std::make_shared<PathTrajectory>(
                    stop_after(scene, m.from, m.acceleration, scene.body(v).max_decel))});
  }
}

/// The scene without all that a group has nothing to do with.
RoadScene scene_of(const RoadScene& scene, const Keys& group) {
  RoadScene part{.library = scene.library, .grid = scene.grid, .step = scene.step};
  for (const std::int64_t key : group) part.vehicles.push_back(scene.vehicle(key));
  const std::vector<Ahead> paths = paths_ahead(part);
  for (const Forecast& f : scene.forecasts) {
    Ahead expected = ahead_of(scene, f.vehicle);
    expected.to = std::max(expected.to, f.trajectory.states.back().s);
    const bool matters = std::ranges::any_of(
        paths, [&](const Ahead& own) { return may_meet(*scene.library, own, expected); });
    if (matters) part.forecasts.push_back(f);
  }
  return part;
}

RoadDecision decide_group(const RoadScene& scene, const Keys& group, const JointPlan& incumbent,
                          const Keys& order, const RoadEscotOptions& options) {
  const RoadScene part = scene_of(scene, group);
  const RoadPairs pairs(part);
  Keys keys;
  JointPlan own;  // in the order of the incumbent, which is that of priority
  for (const JointPlan::Entry& e : incumbent.entries) {
    if (!std::ranges::binary_search(group, e.key)) continue;
    keys.push_back(e.key);
    own.entries.push_back(e);
  }
  for (const std::int64_t key : order) {
    if (std::ranges::binary_search(group, key)) keys.push_back(key);
  }
  const std::uint64_t seed = options.seed + std::uint64_t(scene.step) * 1000003U +
                             std::uint64_t(group.front()) * 0x9e3779b97f4a7c15U;
  CrossingResult result =
      plan_crossing(pairs, keys, own, options.crossing, seed, WorkBudget{options.work});
  RoadDecision decision{.plan = std::move(result.plan), .cost = result.cost};
  if (decision.plan.entries.size() < group.size()) step_the_rest(pairs, decision, options);
  return decision;
}

/// Other threads are worth waking if there is something to do beside the largest group.
int threads_for(const std::vector<Keys>& groups, const RoadEscotOptions& options) {
  constexpr std::size_t kWorthIt = 200;  // pairs of vehicles
  std::size_t all = 0;
  std::size_t most = 0;
  for (const Keys& group : groups) {
    all += group.size() * group.size();
    most = std::max(most, group.size() * group.size());
  }
  if (all - most < kWorthIt) return 1;
  const int cores = tbb::info::default_concurrency();
  return options.threads > 0 ? std::min(options.threads, cores) : cores;
}

}  // namespace

std::vector<Keys> group_vehicles(const RoadScene& scene) {
  const std::vector<Ahead> paths = paths_ahead(scene);
  std::vector<int> component(paths.size(), -1);
  int components = 0;
  for (std::size_t first = 0; first < paths.size(); ++first) {
    if (component[first] >= 0) continue;
    std::vector<std::size_t> members = {first};
    component[first] = components;
    for (std::size_t m = 0; m < members.size(); ++m) {
      for (std::size_t p = 0; p < paths.size(); ++p) {
        if (component[p] >= 0 || !may_meet(*scene.library, paths[members[m]], paths[p])) continue;
        component[p] = components;
        members.push_back(p);
      }
    }
    ++components;
  }
  std::vector<Keys> groups(static_cast<std::size_t>(components));
  for (const RoadVehicle& v : scene.vehicles) {
    const auto own = std::ranges::find_if(
        paths, [&](const Ahead& a) { return a.path == v.path && a.exit_lane == v.exit_lane; });
    groups[std::size_t(component[std::size_t(own - paths.begin())])].push_back(v.key);
  }
  std::ranges::sort(groups);
  return groups;
}

RoadDecision decide_on_road(const RoadScene& scene, const JointPlan& incumbent, const Keys& order,
                            const RoadEscotOptions& options) {
  RoadDecision decision;
  decision.members = group_vehicles(scene);  // Alg. 2, line 12
  decision.groups = int(decision.members.size());
  std::vector<RoadDecision> parts(decision.members.size());
  const auto decide_one = [&](std::size_t g) {  // lines 13-21
    parts[g] = decide_group(scene, decision.members[g], incumbent, order, options);
  };
  const int threads = threads_for(decision.members, options);
  if (threads < 2) {
    for (std::size_t g = 0; g < parts.size(); ++g) decide_one(g);
  } else {
    tbb::task_arena arena(threads);
    arena.execute([&] { tbb::parallel_for(std::size_t{0}, parts.size(), decide_one); });
  }
  for (RoadDecision& part : parts) {
    for (JointPlan::Entry& e : part.plan.entries) decision.plan.entries.push_back(std::move(e));
    decision.stepped += part.stepped;
    decision.all_stepped |= part.all_stepped;
    decision.cost += part.cost;
  }
  return decision;
}

RoadStepWorld::RoadStepWorld(const RoadPairs& pairs, const JointPlan& complete,
                             const WholeTrajectoryOptions& options)
    : pairs_(pairs), complete_(complete), options_(options) {
  const std::size_t n = pairs.scene().vehicles.size();
  near_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      if (i != j && !pairs.between(i, j).contact->never()) near_[i].push_back(int(j));
    }
  }
}

namespace {

/// Could the vehicle stop before a line, but not any longer after this decision? Then it has to be
/// stopped: only a complete plan leads over a stop line.
bool runs_over_a_line(const RoadVehicle& v, const Vehicle& body, const InertialState& from,
                      const InertialState& to) {
  const auto line =
      std::ranges::lower_bound(v.stop_lines, from.s + stopping_distance(from.v, body.max_decel));
  return line != v.stop_lines.end() && to.s + stopping_distance(to.v, body.max_decel) > *line;
}

}  // namespace

std::vector<RoadStepWorld::Motion> RoadStepWorld::candidates(int i, const State& state) const {
  const RoadVehicle& v = vehicle(i);
  const Vehicle& body = scene().body(v);
  const double h = scene().grid.decision();
  const WaitTest wait(pairs_, v, complete_.entries, options_);
  const std::int64_t then = scene().step + scene().grid.steps_per_decision;
  std::vector<Motion> clear;
  std::vector<Motion> blocking;
  for (const double a :
       {body.max_accel, 0.5 * body.max_accel, 0.0, -0.5 * body.max_decel, -body.max_decel}) {
    const Motion m{state, a, advance(state, a, h)};
    if (a > -body.max_decel && m.to.v > v.envelope->at(m.to.s)) continue;
    if (a > -body.max_decel && runs_over_a_line(v, body, state, m.to)) continue;
    if (a > -body.max_decel && !wait.clear_of_forecasts(state, a, m.to)) continue;
    // Who stands where somebody passes who does not yield is run into.
    if (a > -body.max_decel && !wait.leaves_passages_free(then, m.to)) continue;
    const bool keeps_clear = wait.can_wait(then, m.to);
    (keeps_clear ? clear : blocking).push_back(m);
  }
  clear.insert(clear.end(), blocking.begin(), blocking.end());
  return clear;
}

RoadStepWorld::Motion RoadStepWorld::safe_stop(int i, const State& state) const {
  const double b = scene().body(vehicle(i)).max_decel;
  return {state, -b, advance(state, -b, scene().grid.decision())};
}

bool RoadStepWorld::conflict(int i, const Motion& a, int j, const Motion& b) const {
  if (i > j) return conflict(j, b, i, a);
  const RoadContact& contact = *pairs_.between(std::size_t(i), std::size_t(j)).contact;
  const double reach_a = a.to.s + stopping_distance(a.to.v, scene().body(vehicle(i)).max_decel);
  const double reach_b = b.to.s + stopping_distance(b.to.v, scene().body(vehicle(j)).max_decel);
  if (!contact.seen_from_a().reaches(a.from.s, reach_a, b.from.s, reach_b)) return false;
  const double dt = scene().grid.dt;
  const bool lenient = contact.is_close(a.from, b.from);
  const auto position_a = [&](int k) { return advance(a.from, a.acceleration, k * dt).s; };
  const auto position_b = [&](int k) { return advance(b.from, b.acceleration, k * dt).s; };
  return contact.touch(position_a, position_b, scene().grid.steps_per_decision, lenient) ||
         contact.touch_braking(a.to, b.to, lenient);
}

}  // namespace mvtp
