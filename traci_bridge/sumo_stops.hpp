#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>

#include "coordinator/network/road_network.hpp"
#include "coordinator/traffic.hpp"
#include "traci_bridge/sumo_api.hpp"
#include "traci_bridge/sumo_clock.hpp"
#include "traci_bridge/sumo_holds.hpp"
#include "traci_bridge/sumo_routes.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {

/// The stops of vehicles, on the road and in parking areas.
class SumoStops {
 public:
  /// All of these must outlive it.
  SumoStops(const RoadNetwork& network, const SumoHolds& holds, const SumoRoutes& routes,
            const SumoClock& clock)
      : network_(network), holds_(holds), routes_(routes), clock_(clock) {}

  /// See Traffic for these.
  [[nodiscard]] std::optional<Stop> next(const std::string& id) const;
  [[nodiscard]] std::optional<ParkingStop> parking(const std::string& id) const;
  void drop_parking(const std::string& id);

  /// Parked, without a stop from the next step on.
  [[nodiscard]] const std::set<std::string>& leaving() const { return leaving_; }
  /// To be called before each step. A vehicle that leaves goes by the lane beside its area, if only
  /// for a moment: moveToXY in the same step takes it away from there. It waits for room, as SUMO
  /// would try it again in later steps, when it is long under control, and in the end remove it
  /// twice.
  void leave_parking_areas();
  void forget_if(const std::function<bool(const std::string&)>& has_left);

 private:
  const RoadNetwork& network_;
  const SumoHolds& holds_;
  const SumoRoutes& routes_;
  const SumoClock& clock_;
  std::set<std::string> leaving_;
};

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
