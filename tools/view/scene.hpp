#pragma once

#include "coordinator/road_network.hpp"
#include "planner/problem/instance.hpp"
#include "planner/problem/plan.hpp"
#include "tools/view/replay.hpp"

namespace mvtp {

/// The lanes open to traffic and the junctions of a road network.
[[nodiscard]] ReplayScene scene_of(const RoadNetwork& network);

/// The border and the obstacles of a map.
[[nodiscard]] ReplayScene scene_of(const Map& map);

/// A plan as a replay, with a frame per step; every step is shown as the arc it is.
/// Agents and trajectories are matched by name. Without a plan (no trajectories) the replay shows
/// the instance at its start.
/// @throws InputError, naming `where`, if the plan has an agent that the instance lacks, or lacks
/// one.
[[nodiscard]] Replay replay_of(const Instance& instance, const Plan& plan, ReplayInfo info,
                               const std::string& where);

}  // namespace mvtp
