#include "tests/tools/toio/random_plans.hpp"

#include <numbers>
#include <random>

#include "planner/geometry/oriented_box.hpp"
#include "planner/problem/validate.hpp"
#include "planner/solve.hpp"
#include "tools/toio/plan/path.hpp"

namespace mvtp {
namespace {

constexpr double kSide = 15.0;  // of the map [m of the plan]
constexpr Vehicle kVehicle{.front = 1.5,
                           .rear = 1.1,
                           .width = 2.3,
                           .wheelbase = 1.5,
                           .min_turning_radius = 2.0,
                           .max_speed = 1.0};

/// Poses at random whose bodies keep apart from those before and from the border.
Pose place(std::mt19937_64& dice, const std::vector<Pose>& others) {
  const auto between = [&](double low, double high) {
    return low + (high - low) * double(dice() >> 11U) * 0x1p-53;
  };
  while (true) {
    const Pose pose{between(2.0, kSide - 2.0), between(2.0, kSide - 2.0),
                    between(-std::numbers::pi, std::numbers::pi)};
    bool free = true;
    for (const Pose& other : others) {
      free = free && separation(footprint(kVehicle, pose), footprint(kVehicle, other)) > 0.5;
    }
    if (free) return pose;
  }
}

}  // namespace

std::optional<ToioRun> random_run(std::uint64_t seed) {
  std::mt19937_64 dice(seed);
  Instance instance;
  instance.map = {.width = kSide, .height = kSide, .bounds = Bounds::kFootprint};
  const std::size_t robots = 4 + seed % 3;
  std::vector<Pose> starts;
  std::vector<Pose> goals;
  for (std::size_t i = 0; i < robots; ++i) {
    starts.push_back(place(dice, starts));
    goals.push_back(place(dice, goals));
    instance.agents.push_back({"agent" + std::to_string(i), kVehicle, starts[i], goals[i]});
  }
  const Plan plan = solve(instance, {.seed = seed}, Deadline::in(2.0));
  if (plan.statistics.status != to_string(Status::kSolved)) return std::nullopt;
  if (!find_violations(instance, plan, CollisionRule::kContinuous).empty()) return std::nullopt;
  std::vector<PlannedRobot> planned;
  for (std::size_t i = 0; i < robots; ++i) {
    planned.push_back(
        {plan.names[i], kVehicle, starts[i], legs_of(plan.trajectories[i], plan.names[i])});
  }
  const FitOptions fitting;
  const Fit fit = fit_to_mat(planned, instance.dt, find_mat("collection-ring"), fitting);
  if (!fit.problem.empty()) return std::nullopt;
  Exported exported = make_run(planned, instance.dt, fit, fitting, {});
  if (!exported.problem.empty()) return std::nullopt;
  return exported.run;
}

std::vector<ToioRun> random_runs(std::size_t count) {
  std::vector<ToioRun> runs;
  for (std::uint64_t seed = 0; runs.size() < count; ++seed) {
    if (std::optional<ToioRun> run = random_run(seed)) runs.push_back(std::move(*run));
  }
  return runs;
}

}  // namespace mvtp
