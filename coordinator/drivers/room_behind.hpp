#pragma once

#include <functional>
#include <optional>
#include <span>

#include "coordinator/corridor/corridor.hpp"
#include "coordinator/network/lane_graph.hpp"
#include "coordinator/traffic.hpp"

namespace mvtp {

/// [m] between the tail of one who waits and the junction behind him, at least.
inline constexpr double kClearOfJunction = 2.0;

/// The length of a vehicle [m]; none of one that does not matter.
using LengthOf = std::function<std::optional<double>(const VehicleState&)>;

/// Where the first tail is on a corridor if everybody stops now: the station of the rear axle of
/// one that follows on it, with its front at that tail [m]; infinity if nobody is there. Whoever is
/// on a junction is not there yet, or goes on.
/// @param from  station behind which somebody matters [m]
/// @param decel  of those who stop [m/s^2]
[[nodiscard]] double first_tail_at_rest(const Corridor& corridor, const LaneGraph& graph,
                                        double from, double decel,
                                        std::span<const VehicleState> vehicles,
                                        const LengthOf& length_of);

}  // namespace mvtp
