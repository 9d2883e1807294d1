#pragma once

#include <vector>

#include "coordinator/network/road_network.hpp"

namespace mvtp {

/// The ground at both ends of each crossing where people stand who wait for it: their bodies at the
/// kerb, in the frame of the network [m].
[[nodiscard]] std::vector<Polygon> kerbs_where_people_wait(const RoadNetwork& network);

}  // namespace mvtp
