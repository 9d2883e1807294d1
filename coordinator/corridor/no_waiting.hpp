#pragma once

#include <utility>
#include <vector>

#include "coordinator/corridor/corridor.hpp"

namespace mvtp {

/// Where the front bumper is on a lane between two of its junctions: the rear axle, from and to
/// [m].
[[nodiscard]] std::vector<std::pair<double, double>> lanes_between(const LaneGraph& graph,
                                                                   const Corridor& corridor);

/// From `before` [m] ahead of each stop line until the tail of a vehicle has left the junction,
/// from and to [m] of its rear axle: who waits there blocks people, or others at the next green.
[[nodiscard]] std::vector<std::pair<double, double>> inside_junctions(const Corridor& corridor,
                                                                      double length, double before);

/// Before each stop line, from where on a vehicle of this length has to start to be fast when it
/// gets there, to the line [m] of its rear axle; less where there is little road.
[[nodiscard]] std::vector<std::pair<double, double>> run_ups(const Corridor& corridor,
                                                             double length);

}  // namespace mvtp
