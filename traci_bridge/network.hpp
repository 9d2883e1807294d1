#pragma once

#include <string>

#include "coordinator/network/road_network.hpp"
#include "planner/problem/interruption.hpp"

namespace mvtp {

/// Reads a SUMO network (*.net.xml).
///
/// The lanes of the edges that vehicles use, normal and internal ones; footpaths and pedestrian
/// crossings are left out. The connections of a junction are those between normal lanes, each with
/// its whole chain of internal lanes (a turn that waits inside the junction has two of them).
/// Throws InputError, naming file and line, for anything that is not a complete network, and for
/// lanes of more than 100 km or wider than 1 km, and junctions of more than 10 km around.
/// @param point  called for every edge, junction and connection
[[nodiscard]] RoadNetwork read_network(const std::string& path,
                                       const InterruptionPoint& point = never_interrupted);

}  // namespace mvtp
