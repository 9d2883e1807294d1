#pragma once

#include <span>
#include <string>

#include "coordinator/road_network.hpp"

namespace mvtp {

/// How long a vehicle needs for its route without any other vehicle: each lane at its own multiple
/// of the speed limit, but no faster than the vehicle can drive; speed changes take no time [s].
///
/// @param route        edges in driving order, not empty, all in the network.
/// @param first_lane   where it departs; the other lanes are those of the first fitting connection.
/// @param from, to     position of the front bumper on the first and on the last lane [m].
/// @param max_speed    of the vehicle [m/s].
[[nodiscard]] double free_flow_duration(const RoadNetwork& network,
                                        std::span<const std::string> route,
                                        const std::string& first_lane, double from, double to,
                                        double speed_factor, double max_speed);

}  // namespace mvtp
