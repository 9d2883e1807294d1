// Times of the pieces that planning spends its time in.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "planner/escot/escot.hpp"
#include "planner/escot/generate_config.hpp"
#include "planner/escot/planning_problem.hpp"
#include "planner/escot/stepped_world.hpp"
#include "planner/geometry/oriented_box.hpp"
#include "planner/search/spacetime_hybrid_astar.hpp"
#include "planner/search/timed_obstacles.hpp"
#include "tools/generate/random_instance.hpp"

namespace mvtp {
namespace {

constexpr std::size_t kSamples = 2048;

/// Random robots at the density of 100 on 100 x 100 m.
Instance scene(int robots, int obstacles, const std::string& vehicle = "cl-cbs", int index = 0) {
  const int side = int(std::lround(10.0 * std::sqrt(double(robots))));
  const Cell cell{Suite::kCrowd, Layout::kRandom, side, obstacles, robots, 1};
  return generate_instance(cell, {.vehicle = vehicle}, index).instance;
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
  const PlanningProblem planning_problem(instance, CollisionRule::kContinuous);
  std::mt19937_64 rng(1);
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < kSamples; ++i) poses.push_back(random_pose(rng, 100.0));
  for (const Pose& pose : poses)
    benchmark::DoNotOptimize(planning_problem.cost_to_go(0)(pose));  // fills it
  std::size_t i = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(planning_problem.cost_to_go(0)(poses[i++ % kSamples]));
}
BENCHMARK(cost_to_go)->ArgName("obstacles")->Arg(0)->Arg(50);

// ---- one search

/// The path of robot 0 past so many others that follow theirs.
void low_level_search(benchmark::State& state) {
  const Instance instance = scene(100, 50);
  const PlanningProblem planning_problem(instance, CollisionRule::kContinuous);
  const SpacetimeHybridAstar planner(planning_problem.curves());
  const auto search = [&](int i, const TimedObstacles* others) {
    SearchProblem problem;
    problem.car = &planning_problem.car(i);
    problem.cost_to_go = &planning_problem.cost_to_go(i);
    problem.start = instance.agents[std::size_t(i)].start;
    problem.to_avoid = {&others, std::size_t(others == nullptr ? 0 : 1)};
    return planner.search(problem, {}, Deadline::never());
  };
  std::vector<SweptTrajectory> others;
  for (int i = 1; i <= state.range(0); ++i) {
    const std::vector<Arc> steps = search(i, nullptr).value().steps;
    others.emplace_back(planning_problem.car(i), instance.agents[std::size_t(i)].start, steps);
  }
  std::vector<const SweptTrajectory*> pointers;
  for (const SweptTrajectory& other : others) pointers.push_back(&other);
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

/// The mean over the first 30 steps; the first reference paths are found before the clock runs.
void one_step(benchmark::State& state, bool grouping) {
  constexpr int kSteps = 30;
  const Instance instance = scene(int(state.range(0)), 0);
  const Deadline deadline = Deadline::never();
  const PlanningProblem planning_problem(instance, CollisionRule::kContinuous);
  SteppedWorldOptions options;
  options.grouping = grouping;
  std::optional<SteppedWorld> world;
  Configuration q;
  int step = kSteps;
  for (auto _ : state) {
    if (step == kSteps) {
      state.PauseTiming();
      world.emplace(planning_problem, options, deadline);
      q = planning_problem.starts();
      world->update_reference_paths(q);
      step = 0;
      state.ResumeTiming();
    }
    world->update_reference_paths(q);
    const std::vector<SteppedWorld::Motion> motions = generate_config(*world, q);
    world->advance(motions);
    for (std::size_t i = 0; i < q.size(); ++i) q[i] = motions[i].end;
    ++step;
  }
}

/// Until everybody is at its goal, first reference paths included; `step` is the mean time of one.
void whole_run(benchmark::State& state) {
  const Instance instance = scene(int(state.range(0)), 0);
  const PlanningProblem planning_problem(instance, CollisionRule::kContinuous);
  double steps = 0.0;
  for (auto _ : state) {
    const PlannerResult plan = solve_escot(planning_problem, {}, Deadline::never());
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

// ---- growth of a step of ESCoT with the number of robots

constexpr std::array kSizes = {50, 100, 200, 400};
constexpr int kInstances = 7;  // of each size

/// Processor time, which other jobs on the machine touch less than the clock on the wall.
double milliseconds(const std::function<void()>& work) {
  const std::clock_t begin = std::clock();
  work();
  return 1000.0 * double(std::clock() - begin) / CLOCKS_PER_SEC;
}

/// The first 30 steps; the first reference paths are found before the clock runs.
std::optional<double> step_of_the_first(const PlanningProblem& planning_problem) {
  constexpr int kSteps = 30;
  const Deadline deadline = Deadline::never();
  SteppedWorld world(planning_problem, {}, deadline);
  Configuration q = planning_problem.starts();
  world.update_reference_paths(q);
  return milliseconds([&] {
           for (int step = 0; step < kSteps; ++step) {
             world.update_reference_paths(q);
             const std::vector<SteppedWorld::Motion> motions = generate_config(world, q);
             world.advance(motions);
             for (std::size_t i = 0; i < q.size(); ++i) q[i] = motions[i].end;
           }
         }) /
         kSteps;
}

/// All steps until everybody is at its goal, first reference paths included; nullopt: not in 30 s.
std::optional<double> step_of_a_run(const PlanningProblem& planning_problem) {
  PlannerResult plan;
  const double time =
      milliseconds([&] { plan = solve_escot(planning_problem, {}, Deadline::in(30)); });
  if (plan.status != Status::kSolved) return std::nullopt;
  return time / double(plan.trajectories.front().makespan());
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return (values[(n - 1) / 2] + values[n / 2]) / 2;
}

/// The slope of the line through (log n, log y) with the least squares.
double exponent(const std::array<double, kSizes.size()>& y) {
  double mean_x = 0.0;
  double mean_y = 0.0;
  for (std::size_t k = 0; k < y.size(); ++k) {
    mean_x += std::log(kSizes[k]) / double(y.size());
    mean_y += std::log(y[k]) / double(y.size());
  }
  double along = 0.0;
  double squares = 0.0;
  for (std::size_t k = 0; k < y.size(); ++k) {
    const double dx = std::log(kSizes[k]) - mean_x;
    along += dx * (std::log(y[k]) - mean_y);
    squares += dx * dx;
  }
  return along / squares;
}

/// The processor time of one step [ms], the median over instances of each size, and the exponent
/// that fits.
///
/// Sizes alternate, and the quick ones come several times, so that all see the same of what else
/// the machine does.
void growth(benchmark::State& state, const std::string& vehicle,
            std::optional<double> (*time_of_step)(const PlanningProblem&)) {
  std::array<std::vector<double>, kSizes.size()> times;
  int unsolved = 0;
  for (auto _ : state) {
    for (int index = 0; index < kInstances; ++index) {
      for (std::size_t k = 0; k < kSizes.size(); ++k) {
        const Instance instance = scene(kSizes[k], 0, vehicle, index);
        std::vector<double> of_instance;
        for (int turn = kSizes[k]; turn <= kSizes.back(); turn *= 2) {
          const PlanningProblem planning_problem(instance, CollisionRule::kContinuous);
          const std::optional<double> time = time_of_step(planning_problem);
          unsolved += time || turn != kSizes[k] ? 0 : 1;
          if (time) of_instance.push_back(*time);
        }
        if (!of_instance.empty()) times[k].push_back(median(of_instance));
      }
    }
  }
  std::array<double, kSizes.size()> medians = {};
  for (std::size_t k = 0; k < kSizes.size(); ++k) {
    if (times[k].empty()) return state.SkipWithError("a size without a solved instance");
    medians[k] = median(times[k]);
    state.counters["ms_" + std::to_string(kSizes[k])] = medians[k];
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  state.counters["exponent"] = exponent(medians);
  state.counters["unsolved"] = unsolved;
  state.counters["peak_MiB"] = double(usage.ru_maxrss) / 1024.0;
}
BENCHMARK_CAPTURE(growth, of_first_steps_escot, "escot", step_of_the_first)->Iterations(1);
BENCHMARK_CAPTURE(growth, of_first_steps_cl_cbs, "cl-cbs", step_of_the_first)->Iterations(1);
BENCHMARK_CAPTURE(growth, of_whole_runs_escot, "escot", step_of_a_run)->Iterations(1);
BENCHMARK_CAPTURE(growth, of_whole_runs_cl_cbs, "cl-cbs", step_of_a_run)->Iterations(1);

}  // namespace
}  // namespace mvtp

BENCHMARK_MAIN();
