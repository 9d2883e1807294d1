// Times of the pieces that planning spends its time in.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "planner/algorithms/escot.hpp"
#include "planner/algorithms/fleet.hpp"
#include "planner/algorithms/generate_config.hpp"
#include "planner/algorithms/stepped_world.hpp"
#include "planner/motion/oriented_box.hpp"
#include "planner/search/spacetime_hybrid_astar.hpp"
#include "planner/search/timed_obstacles.hpp"
#include "tools/generate/random_instance.hpp"

namespace mvtp {
namespace {

constexpr std::size_t kSamples = 2048;

/// Random robots at the density of 100 on 100 x 100 m, with the vehicle of CL-CBS.
Instance scene(int robots, int obstacles) {
  const int side = int(std::lround(10.0 * std::sqrt(double(robots))));
  const Cell cell{Suite::kCrowd, Layout::kRandom, side, obstacles, robots, 1};
  return generate_instance(cell, {.vehicle = "cl-cbs"}, 0).instance;
}

double between(std::mt19937_64& rng, double low, double high) {
  return low + (high - low) * double(rng() >> 11U) * 0x1p-53;
}

Pose random_pose(std::mt19937_64& rng, double side) {
  return {between(rng, 0, side), between(rng, 0, side), between(rng, -3.14, 3.14)};
}

/// Sweeps of one metre in a square; the smaller, the more of them collide.
std::vector<Sweep> random_sweeps(double side) {
  std::mt19937_64 rng(1);
  std::vector<Sweep> sweeps;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const Pose pose = random_pose(rng, side);
    sweeps.emplace_back(Vehicle{}, pose, Arc{1.0, between(rng, -0.4, 0.4)});
  }
  return sweeps;
}

// ---- collision

void separation_of_boxes(benchmark::State& state) {
  std::mt19937_64 rng(1);
  std::vector<OrientedBox> boxes;
  for (std::size_t i = 0; i < kSamples; ++i) {
    boxes.push_back(footprint(Vehicle{}, random_pose(rng, 8.0)));
  }
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(separation(boxes[i % kSamples], boxes[(i + 1) % kSamples]));
    ++i;
  }
}
BENCHMARK(separation_of_boxes);

void sweep_against_sweep(benchmark::State& state) {
  const std::vector<Sweep> sweeps = random_sweeps(double(state.range(0)));
  std::size_t i = 0;
  std::size_t hits = 0;
  for (auto _ : state) {
    hits += collide(sweeps[i % kSamples], sweeps[(i + 1) % kSamples]) ? 1 : 0;
    ++i;
  }
  state.counters["colliding"] = double(hits) / double(i);
}
BENCHMARK(sweep_against_sweep)->ArgName("side_m")->Arg(8)->Arg(100);

void sweep_against_obstacles(benchmark::State& state) {
  const Instance instance = scene(100, 50);
  const Obstacles obstacles(instance.map, 5.0);
  const std::vector<Sweep> sweeps = random_sweeps(100.0);
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(obstacles.hit(sweeps[i++ % kSamples]));
}
BENCHMARK(sweep_against_obstacles);

void making_a_sweep(benchmark::State& state) {
  std::mt19937_64 rng(1);
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < kSamples; ++i) poses.push_back(random_pose(rng, 100.0));
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(Sweep(Vehicle{}, poses[i++ % kSamples], Arc{1.0, 0.3}));
  }
}
BENCHMARK(making_a_sweep);

// ---- cost-to-go

void cost_to_go(benchmark::State& state) {
  const Instance instance = scene(100, int(state.range(0)));
  const Fleet fleet(instance, CollisionRule::kContinuous);
  std::mt19937_64 rng(1);
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < kSamples; ++i) poses.push_back(random_pose(rng, 100.0));
  for (const Pose& pose : poses) benchmark::DoNotOptimize(fleet.cost_to_go(0)(pose));  // fills it
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(fleet.cost_to_go(0)(poses[i++ % kSamples]));
}
BENCHMARK(cost_to_go)->ArgName("obstacles")->Arg(0)->Arg(50);

// ---- one search

/// The way of robot 0 past so many others that follow theirs.
void low_level_search(benchmark::State& state) {
  const Instance instance = scene(100, 50);
  const Fleet fleet(instance, CollisionRule::kContinuous);
  const SpacetimeHybridAstar planner(fleet.curves());
  const auto search = [&](int i, const TimedObstacles* others) {
    SearchProblem problem;
    problem.car = &fleet.car(i);
    problem.cost_to_go = &fleet.cost_to_go(i);
    problem.start = instance.agents[std::size_t(i)].start;
    problem.to_avoid = {&others, std::size_t(others == nullptr ? 0 : 1)};
    return planner.search(problem, {}, Deadline::never());
  };
  std::vector<MovingObstacle> others;
  for (int i = 1; i <= state.range(0); ++i) {
    const std::vector<Arc> steps = search(i, nullptr).value().steps;
    others.emplace_back(fleet.car(i), instance.agents[std::size_t(i)].start, steps);
  }
  std::vector<const MovingObstacle*> pointers;
  for (const MovingObstacle& other : others) pointers.push_back(&other);
  const TimedObstacles traffic(pointers);
  for (auto _ : state) benchmark::DoNotOptimize(search(0, &traffic));
}
BENCHMARK(low_level_search)
    ->ArgName("others")
    ->Arg(0)
    ->Arg(20)
    ->Arg(99)
    ->Unit(benchmark::kMicrosecond);

// ---- one step of all robots

/// The mean over the first 30 steps; the first guide paths are found before the clock runs.
void one_step(benchmark::State& state, bool grouping) {
  constexpr int kSteps = 30;
  const Instance instance = scene(int(state.range(0)), 0);
  const Deadline deadline = Deadline::never();
  const Fleet fleet(instance, CollisionRule::kContinuous);
  SteppedWorldOptions options;
  options.grouping = grouping;
  std::optional<SteppedWorld> world;
  Configuration q;
  int step = kSteps;
  for (auto _ : state) {
    if (step == kSteps) {
      state.PauseTiming();
      world.emplace(fleet, options, deadline);
      q = fleet.starts();
      world->prepare(q);
      step = 0;
      state.ResumeTiming();
    }
    world->prepare(q);
    const std::vector<SteppedWorld::Motion> motions = generate_config(*world, q);
    world->advance(motions);
    for (std::size_t i = 0; i < q.size(); ++i) q[i] = motions[i].end;
    ++step;
  }
}

/// Until everybody is at its goal, first guide paths included; `step` is the mean time of one.
void whole_run(benchmark::State& state) {
  const Instance instance = scene(int(state.range(0)), 0);
  const Fleet fleet(instance, CollisionRule::kContinuous);
  double steps = 0.0;
  for (auto _ : state) {
    const StepPlan plan = solve_escot(fleet, {}, Deadline::never());
    if (plan.status != Status::kSolved) state.SkipWithError("not solved");
    steps += double(plan.trajectories.front().makespan());
  }
  using benchmark::Counter;
  state.counters["step"] = Counter(steps, Counter::kIsRate | Counter::kInvert);
}

void one_step_of_pbcr(benchmark::State& state) { one_step(state, false); }
void one_step_of_escot(benchmark::State& state) { one_step(state, true); }
// Whole runs of 30 steps, as early ones cost more than late ones.
BENCHMARK(one_step_of_pbcr)
    ->ArgName("robots")
    ->Arg(50)
    ->Arg(100)
    ->Arg(200)
    ->Arg(400)
    ->Iterations(300)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(one_step_of_escot)
    ->ArgName("robots")
    ->Arg(50)
    ->Arg(100)
    ->Arg(200)
    ->Arg(400)
    ->Iterations(60)
    ->Unit(benchmark::kMicrosecond);

void whole_run_of_escot(benchmark::State& state) { whole_run(state); }
BENCHMARK(whole_run_of_escot)
    ->ArgName("robots")
    ->Arg(50)
    ->Arg(100)
    ->Arg(200)
    ->Arg(400)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mvtp

BENCHMARK_MAIN();
