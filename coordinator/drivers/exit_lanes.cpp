#include "coordinator/drivers/exit_lanes.hpp"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "planner/road.hpp"

namespace mvtp {

ExitLanes::ExitLanes(Traffic& traffic, LaneKeeping& keeping, const LaneGraph& graph,
                     LeavingOf leaving_of, TypeOf type_of)
    : traffic_(traffic),
      keeping_(keeping),
      graph_(graph),
      leaving_of_(std::move(leaving_of)),
      type_of_(std::move(type_of)) {}

/// Where its tail comes to rest on its lane if it brakes [m].
double ExitLanes::stops_at(const VehicleState& driver) const {
  const Vehicle& body = type_of_(driver.type).body;
  return driver.lane_position - body.length() + stopping_distance(driver.speed, body.max_decel);
}

void ExitLanes::show() {
  std::vector<Room> rooms;
  std::vector<const VehicleState*> drivers;
  for (const VehicleState& v : traffic_.vehicles()) {
    const std::optional<Leaving> leaving = leaving_of_(v.id);
    if (!leaving) {
      drivers.push_back(&v);
      continue;
    }
    const VehicleType& type = type_of_(v.type);
    const double rests = std::max(type.body.length(), leaving->front + leaving->needs);
    rooms.push_back({graph_.edge_of(leaving->lane), leaving->lane, rests + type.min_gap});
  }
  std::set<std::string> kept;
  for (const VehicleState* v : drivers) {
    const int lane = rooms.empty() ? LaneGraph::kNone : graph_.find_lane(v->lane);
    const bool is_beside =
        lane != LaneGraph::kNone && std::ranges::any_of(rooms, [&](const Room& r) {
          return r.edge == graph_.edge_of(lane) && r.lane != lane && stops_at(*v) < r.end;
        });
    if (is_beside) kept.insert(v->id);
  }
  keeping_.keep_only(std::move(kept), LaneKeeping::Reason::kExit);
}

}  // namespace mvtp
