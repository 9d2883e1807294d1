#pragma once

#include <string>
#include <vector>

#include "planner/problem/instance_file.hpp"
#include "tools/toio/fit.hpp"

namespace mvtp {

/// Where a plan and its vehicles come from.
struct PlanRequest {
  std::string plan;
  std::string instance;  ///< empty: every robot is the preset `reading.vehicle_preset`
  InstanceReadOptions reading;
};

struct LoadedPlan {
  std::vector<PlannedRobot> robots;
  double dt = 1.0;  ///< [s]
};

/// Reads a plan for cubes. With its instance, the referee judges it first.
/// @throws InputError if a file is bad, the plan breaks a rule, or a step is no arc.
[[nodiscard]] LoadedPlan load_plan(const PlanRequest& request);

}  // namespace mvtp
