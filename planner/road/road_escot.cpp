#include "planner/road/road_escot.hpp"

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <map>
#include <optional>

#include "planner/escot/generate_config.hpp"
#include "planner/road/road_world.hpp"

namespace mvtp {
namespace {

using Keys = std::vector<std::int64_t>;

/// What vehicles on one path with one exit lane have still before them.
struct Ahead {
  int path = 0;
  int exit_lane = -1;
  const RoadVehicle* vehicle = nullptr;  ///< one of them
  double from = 0.0;                     ///< [m] rear axle
  double to = 0.0;
};

Ahead ahead_of(const RoadScene& scene, const RoadVehicle& v) {
  // A plan ends with the decision in which it reaches s_end.
  const double beyond = std::max(v.now.v, scene.body(v).max_speed) * scene.grid.decision();
  return {v.path, v.exit_lane, &v, v.now.s, std::max(v.now.s, v.s_end) + beyond};
}

bool may_meet(const PathLibrary& library, const Ahead& a, const Ahead& b) {
  return a.vehicle->exits_with(*b.vehicle) || b.vehicle->exits_with(*a.vehicle) ||
         library.contacts(a.path, b.path).reaches(a.from, a.to, b.from, b.to) ||
         library.reserved(a.path, b.path).reaches(a.from, a.to, b.from, b.to);
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

/// The scene without all that a group has nothing to do with.
RoadScene scene_of(const RoadScene& scene, const Keys& group) {
  RoadScene part = scene.without_vehicles();
  for (const std::int64_t key : group) part.vehicles.push_back(scene.vehicle(key));
  const std::vector<Ahead> paths = paths_ahead(part);
  for (const Forecast& f : scene.forecasts) {
    Ahead expected = ahead_of(scene, f.vehicle);
    expected.to = std::max(expected.to, f.earliest.states.back().s);
    const bool matters = std::ranges::any_of(
        paths, [&](const Ahead& own) { return may_meet(*scene.library, own, expected); });
    if (matters) part.forecasts.push_back(f);
  }
  return part;
}

/// The complete plans as far as everybody makes room for them, and what PBCR decided for the
/// others.
RoadDecision decision_of(const RoadScene& scene, const RoadWorld& world,
                         const std::vector<RoadWorld::Motion>& motions) {
  RoadDecision decision{.plan = world.found().plan, .cost = world.found().cost};
  decision.all_stepped = !world.keeps_plans(motions);
  if (decision.all_stepped) decision.plan.entries.clear();
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const RoadVehicle& v = scene.vehicles[i];
    if (decision.plan.find(v.key)) continue;
    ++decision.stepped;
    const RoadWorld::Motion& m = motions[i];
    decision.plan.entries.push_back(
        {v.key, std::make_shared<SpeedProfile>(
                    stop_after(scene, m.from, m.acceleration, scene.body(v).max_decel))});
  }
  return decision;
}

/// Processor time of this thread [ms].
double thread_clock() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * double(t.tv_sec) + 1e-6 * double(t.tv_nsec);
}

RoadDecision decide_group(const RoadScene& scene, const Keys& group, const JointPlan& incumbent,
                          const Keys& order, const RoadEscotOptions& options,
                          const std::function<bool()>& time_is_up) {
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
  RoadWorld world(pairs, std::move(keys), std::move(own), options, seed,
                  WorkBudget{options.work, time_is_up});
  const std::vector<RoadWorld::State> q = world.states();
  return decision_of(part, world, generate_config(world, q));
}

/// Other threads are worth waking if there is something to do beside the largest group.
int threads_for(const std::vector<Keys>& groups, const RoadEscotOptions& options) {
  std::size_t all = 0;
  std::size_t most = 0;
  for (const Keys& group : groups) {
    all += group.size() * group.size();
    most = std::max(most, group.size() * group.size());
  }
  if (all - most < std::size_t(options.pairs_for_threads)) return 1;
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
  const std::function<double()> clock =
      options.budget.clock ? options.budget.clock : std::function<double()>(thread_clock);
  std::vector<double> took_ms(parts.size());
  const auto decide_one = [&](std::size_t g) {  // lines 13-21
    const double begin = clock();
    const auto time_is_up = [&] { return clock() - begin > 0.5 * options.budget.ms; };
    parts[g] = decide_group(scene, decision.members[g], incumbent, order, options, time_is_up);
    took_ms[g] = clock() - begin;
  };
  const int threads = threads_for(decision.members, options);
  if (threads < 2) {
    for (std::size_t g = 0; g < parts.size(); ++g) decide_one(g);
  } else {
    tbb::task_arena arena(threads);
    arena.execute([&] { tbb::parallel_for(std::size_t{0}, parts.size(), decide_one); });
  }
  for (std::size_t g = 0; g < parts.size(); ++g) {
    if (took_ms[g] > options.budget.ms) decision.late.push_back(g);
  }
  for (RoadDecision& part : parts) {
    for (JointPlan::Entry& e : part.plan.entries) decision.plan.entries.push_back(std::move(e));
    decision.stepped += part.stepped;
    decision.all_stepped |= part.all_stepped;
    decision.cost += part.cost;
    decision.costs.push_back(part.cost);
  }
  return decision;
}

}  // namespace mvtp
