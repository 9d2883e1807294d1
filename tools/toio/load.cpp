#include "tools/toio/load.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "planner/problem/input_error.hpp"
#include "planner/problem/plan_file.hpp"
#include "planner/problem/validate.hpp"

namespace mvtp {
namespace {

constexpr std::size_t kMostRobots = 100;  // far above what Bluetooth adapters connect to

VehiclePreset preset_of(const PlanRequest& request) {
  const std::string name = request.reading.vehicle_preset.value_or("escot");
  const std::optional<VehiclePreset> preset = vehicle_preset(name);
  if (preset) return *preset;
  throw InputError("--vehicle",
                   fmt::format("is the unknown preset \"{}\"; choose escot or cl-cbs", name));
}

void refuse_invalid(const PlanRequest& request, const Instance& instance, const Plan& plan) {
  const std::vector<Violation> violations =
      find_violations(instance, plan, CollisionRule::kContinuous);
  if (violations.empty()) return;
  throw InputError(request.plan,
                   fmt::format("breaks a rule ({}: {}); see mvtp validate",
                               to_string(violations.front().rule), violations.front().message));
}

Vehicle vehicle_of(const Instance& instance, const std::string& name) {
  const auto agent = std::ranges::find(instance.agents, name, &Agent::name);
  return agent->vehicle;  // the referee has found no unknown agent
}

}  // namespace

LoadedPlan load_plan(const PlanRequest& request) {
  LoadedPlan loaded;
  std::optional<Instance> instance;
  VehiclePreset preset;
  PlanReadOptions reading{.yaw = request.reading.yaw, .dt = request.reading.dt.value_or(1.0)};
  if (request.instance.empty()) {
    preset = preset_of(request);
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
  if (instance) refuse_invalid(request, *instance, plan);

  loaded.dt = plan.statistics.dt;
  for (std::size_t i = 0; i < plan.names.size(); ++i) {
    const Trajectory& trajectory = plan.trajectories[i];
    loaded.robots.push_back(
        {plan.names[i], instance ? vehicle_of(*instance, plan.names[i]) : preset.vehicle,
         trajectory.at(0).pose,
         legs_of(trajectory, fmt::format("{}: schedule.{}", request.plan, plan.names[i]))});
  }
  return loaded;
}

}  // namespace mvtp
