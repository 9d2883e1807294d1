#pragma once

#include "coordinator/network/road_network.hpp"
#include "planner/problem/instance.hpp"
#include "tools/view/replay.hpp"

namespace mvtp {

/// The lanes, crossings and junctions of a road network, and where its lights stand; signals are
/// numbered in the order of `network.signals`.
[[nodiscard]] ReplayScene scene_of(const RoadNetwork& network);

/// The border and the obstacles of a map.
[[nodiscard]] ReplayScene scene_of(const Map& map);

}  // namespace mvtp
