#pragma once

#include <span>
#include <string>
#include <vector>

#include "coordinator/network/lane_graph.hpp"

namespace mvtp {

/// Which junctions are coordinated. `ids`: those named; none named: all with conflicting
/// connections. A junction with conflicts less than `chain` metres behind or before one of them on
/// a road is coordinated with it: there is no room to hand vehicles back in between.
/// @throws InputError if an id is not in the network.
[[nodiscard]] std::vector<bool> select_junctions(const LaneGraph& graph,
                                                 std::span<const std::string> ids, double chain);

/// Junctions that one corridor may lead through, and how many connections lead over them.
struct ControlZone {
  std::vector<int> junctions;
  int connections = 0;
};

/// The coordinated junctions in control zones: junctions less than `chain` metres apart are in one.
[[nodiscard]] std::vector<ControlZone> partition(const LaneGraph& graph,
                                                 const std::vector<bool>& coordinated,
                                                 double chain);

}  // namespace mvtp
