#pragma once

#include <map>
#include <string>

#include "coordinator/network/road_network.hpp"

namespace mvtp {

/// The speed at which a vehicle that keeps to the centre line feels `max_lateral_accel` [m/s^2] on
/// the mean radius of each bend, for all internal lanes where that is below their speed limit
/// [m/s].
///
/// SUMO's own limits allow 7.5 m/s^2 on a right turn: 6.5 m/s on a radius of 5.6 m.
[[nodiscard]] std::map<std::string, double> bend_speed_limits(const RoadNetwork& network,
                                                              double max_lateral_accel);

}  // namespace mvtp
