#include "planner/road/emergency_braking.hpp"

#include <algorithm>
#include <memory>

#include "planner/road/surroundings.hpp"

namespace mvtp {
namespace {

/// Is it clear for this vehicle to follow its plan for one decision, and to brake after it?
bool may_go_on(const Surroundings& around, const RoadScene& scene, const RoadVehicle& v,
               const SpeedProfile& plan) {
  const std::int64_t last =
      std::max(scene.step, std::min(scene.step + scene.grid.steps_per_decision, plan.end() - 1));
  const double h = double(last - scene.step) * scene.grid.dt;
  const double a = h > 0.0 ? held_acceleration(v.now, plan.at(last), h) : 0.0;
  return around.step_is_clear(scene.step, v.now, a, advance(v.now, a, scene.grid.decision()));
}

}  // namespace

std::vector<std::int64_t> who_must_brake(const RoadScene& scene, const JointPlan& plan,
                                         const ProfileOptions& options) {
  const RoadPairs pairs(scene);
  std::vector<std::int64_t> braking;
  std::vector<JointPlan::Entry> bodies;
  const auto brake = [&](const RoadVehicle& v) {
    const double b = scene.body(v).max_decel;
    braking.push_back(v.key);
    bodies.push_back({v.key, std::make_shared<SpeedProfile>(stop_after(scene, v.now, -b, b))});
  };
  for (const RoadVehicle& v : scene.vehicles) {
    const Surroundings forecasts(pairs, v, {}, options);
    if (!may_go_on(forecasts, scene, v, *plan.find(v.key))) brake(v);
  }
  for (bool grown = !braking.empty(); grown;) {
    grown = false;
    for (const RoadVehicle& v : scene.vehicles) {
      if (std::ranges::count(braking, v.key) > 0) continue;
      const Surroundings others(pairs, v, bodies, options, Surroundings::Forecasts::kIgnore);
      if (may_go_on(others, scene, v, *plan.find(v.key))) continue;
      brake(v);
      grown = true;
    }
  }
  std::ranges::sort(braking);
  return braking;
}

}  // namespace mvtp
