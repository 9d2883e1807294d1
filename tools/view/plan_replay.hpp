#pragma once

#include <span>
#include <string>

#include "planner/problem/instance.hpp"
#include "planner/problem/plan.hpp"
#include "planner/problem/validate.hpp"
#include "tools/view/replay.hpp"

namespace mvtp {

/// A plan as a replay, with a frame per step; every step is shown as the arc it is.
///
/// Agents and trajectories are matched by name. The figures of time follow from the trajectories,
/// whatever the plan's statistics say. Violations become events.
/// @param where name of the plan's file in messages
/// @throws InputError if the plan has an agent that the instance lacks, or lacks one.
[[nodiscard]] Replay replay_of(const Instance& instance, const Plan& plan,
                               std::span<const Violation> violations, ReplayInfo info,
                               const std::string& where);

/// The instance at its start, with its goals.
[[nodiscard]] Replay replay_of(const Instance& instance, ReplayInfo info);

}  // namespace mvtp
