#pragma once

#include <string>

#include "planner/problem/instance_file.hpp"
#include "planner/problem/plan.hpp"

namespace mvtp {

/// What the user says about a plan file beside what stands in it.
struct PlanReadOptions {
  YawSense yaw = YawSense::kCounterClockwise;  ///< unless the file has `statistics.yaw`
  double dt = 1.0;  ///< duration of one step [s], for files without `statistics.dt`
};

/// Reads a plan: YAML in the result format of CL-CBS and CSDO, with our extensions or without, or
/// the JSON result of Guo and Yu's CarLikePlanning; docs/file-formats.md has every key.
///
/// Waypoints without `v` and `phi` get NaN for both: the referee then infers the arc from the
/// poses.
/// @throws InputError "FILE: schedule.agent0[3].x: ..." at the first value that is missing, of a
/// wrong type, or not finite, and where the steps `t` are not 0, 1, 2, ...
[[nodiscard]] Plan read_plan(const std::string& path, const PlanReadOptions& options = {});

/// The same for the text of such a file. @param name  stands for the file in messages
[[nodiscard]] Plan parse_plan(const std::string& name, const std::string& text,
                              const PlanReadOptions& options = {});

/// Gives the agents of the instance the vehicles that their plan records, if it records any.
/// @return whether that changes one of them
bool take_vehicles(const Plan& plan, Instance& instance);

/// Writes the plan whole or not at all; read_plan() gives back the same numbers, bit by bit.
/// @throws InputError if the file cannot be written; find out before solving with check_writable().
void write_plan(const Plan& plan, const std::string& path,
                YawSense yaw = YawSense::kCounterClockwise);

/// What write_plan() writes.
[[nodiscard]] std::string plan_text(const Plan& plan, YawSense yaw = YawSense::kCounterClockwise);

}  // namespace mvtp
