#include "tools/toio/plan/load.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "planner/problem/input_error.hpp"
#include "planner/problem/plan_file.hpp"
#include "planner/problem/validate.hpp"
#include "planner/problem/vehicle_file.hpp"

namespace mvtp {
namespace {

constexpr std::size_t kMostRobots = 100;  // far above what Bluetooth adapters connect to

void refuse_invalid(const PlanRequest& request, const Instance& instance, const Plan& plan) {
  const std::vector<Violation> violations =
      find_violations(instance, plan, CollisionRule::kContinuous);
  if (violations.empty()) return;
  throw InputError(request.plan,
                   fmt::format("breaks a rule ({}: {}); see mvtp validate",
                               to_string(violations.front().rule), violations.front().message));
}

/// Without an instance: as the user says, or else the plan, or else the default.
std::vector<Vehicle> vehicles_of(const PlanRequest& request, const Plan& plan,
                                 const Vehicle& preset) {
  if (!request.reading.vehicle_preset && !plan.vehicles.empty()) return plan.vehicles;
  return std::vector(plan.names.size(), preset);
}

std::vector<Vehicle> vehicles_of(const Instance& instance, const Plan& plan) {
  std::vector<Vehicle> vehicles;
  for (const std::string& name : plan.names) {  // the referee has found no unknown agent
    vehicles.push_back(std::ranges::find(instance.agents, name, &Agent::name)->vehicle);
  }
  return vehicles;
}

}  // namespace

LoadedPlan load_plan(const PlanRequest& request) {
  LoadedPlan loaded;
  std::optional<Instance> instance;
  VehiclePreset preset;
  PlanReadOptions reading{.yaw = request.reading.yaw, .dt = request.reading.dt.value_or(1.0)};
  if (request.instance.empty()) {
    preset = read_preset("--vehicle", request.reading.vehicle_preset.value_or("escot"));
    reading.dt = request.reading.dt.value_or(preset.dt);
  } else {
    instance = read_instance(request.instance, request.reading);
    reading.dt = instance->dt;
  }
  Plan plan = read_plan(request.plan, reading);
  if (request.reading.dt) plan.statistics.dt = *request.reading.dt;
  if (plan.names.empty()) throw InputError(request.plan, "has no robots; solve an instance first");
  if (plan.names.size() > kMostRobots) {
    throw InputError(request.plan, fmt::format("has {} robots; at most {} cubes can be driven",
                                               plan.names.size(), kMostRobots));
  }
  if (instance) {
    if (!request.reading.vehicle_preset) take_vehicles(plan, *instance);
    refuse_invalid(request, *instance, plan);
  }

  const std::vector<Vehicle> vehicles =
      instance ? vehicles_of(*instance, plan) : vehicles_of(request, plan, preset.vehicle);
  loaded.dt = plan.statistics.dt;
  for (std::size_t i = 0; i < plan.names.size(); ++i) {
    const Trajectory& trajectory = plan.trajectories[i];
    loaded.robots.push_back(
        {plan.names[i], vehicles[i], trajectory.at(0).pose,
         legs_of(trajectory, fmt::format("{}: schedule.{}", request.plan, plan.names[i]))});
  }
  return loaded;
}

}  // namespace mvtp
