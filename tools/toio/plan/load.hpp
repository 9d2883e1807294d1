#pragma once

#include <string>
#include <vector>

#include "planner/problem/instance_file.hpp"
#include "tools/toio/plan/fit.hpp"

namespace mvtp {

/// Where a plan and its vehicles come from.
struct PlanRequest {
  std::string plan;
  /// Empty: robots are the preset `reading.vehicle_preset`, or else what the plan records.
  std::string instance;
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
