#pragma once

#include <functional>
#include <optional>
#include <string>

#include "coordinator/drivers/lane_keeping.hpp"
#include "coordinator/network/lane_graph.hpp"
#include "coordinator/traffic.hpp"

namespace mvtp {

/// Keeps drivers out of the beginning of a lane onto which a vehicle under control is about to
/// leave a junction: who changed into it there could make it stand with its tail inside, where
/// others count on its having left. SUMO's drivers look for a follower on the connections to that
/// lane, but only on those with right of way or green, and plans heed neither.
class ExitLanes {
 public:
  /// A vehicle under control that cannot stop before a junction any more, or is inside.
  struct Leaving {
    int lane = LaneGraph::kNone;  ///< the first behind the junction
    double front = 0.0;           ///< [m] of the front bumper on it; < 0: before its start
    double needs = 0.0;           ///< [m] that it still goes if it brakes
  };
  /// nullopt: it is not about to leave a junction, or has a driver.
  using LeavingOf = std::function<std::optional<Leaving>(const std::string&)>;
  using TypeOf = std::function<const VehicleType&(const std::string&)>;

  /// @param traffic, keeping, graph  must outlive it.
  ExitLanes(Traffic& traffic, LaneKeeping& keeping, const LaneGraph& graph, LeavingOf leaving_of,
            TypeOf type_of);

  /// To be called before each step.
  void show();

 private:
  /// Room on a lane: a driver beside it who stops before its end is not to change into it.
  struct Room {
    int edge = 0;
    int lane = 0;
    double end = 0.0;  ///< [m]
  };
  [[nodiscard]] double stops_at(const VehicleState& driver) const;

  Traffic& traffic_;
  LaneKeeping& keeping_;
  const LaneGraph& graph_;
  LeavingOf leaving_of_;
  TypeOf type_of_;
};

}  // namespace mvtp
