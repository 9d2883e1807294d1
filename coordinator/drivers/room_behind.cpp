#include "coordinator/drivers/room_behind.hpp"

#include <algorithm>
#include <limits>

#include "planner/road.hpp"

namespace mvtp {

double first_tail_at_rest(const Corridor& corridor, const LaneGraph& graph, double from,
                          double decel, std::span<const VehicleState> vehicles,
                          const LengthOf& length_of) {
  double first = std::numeric_limits<double>::infinity();
  for (const VehicleState& v : vehicles) {
    const std::optional<double> length = length_of(v);
    if (!length) continue;
    const int lane = graph.find_lane(v.lane);
    if (lane == LaneGraph::kNone || graph.edge_of(lane) == LaneGraph::kNone) continue;
    const std::optional<double> s = corridor.station(lane, v.lane_position, from);
    if (!s || *s < from) continue;
    first = std::min(first, *s - *length + stopping_distance(v.speed, decel));
  }
  return first;
}

}  // namespace mvtp
