#pragma once

#include <map>
#include <string>

#include "coordinator/network/road_network.hpp"
#include "traci_bridge/sumo_api.hpp"
#include "traci_bridge/sumo_drivers.hpp"
#include "traci_bridge/sumo_log.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {

/// Keeps vehicles with human drivers from leaving their lanes, by stops at the ends of these; who
/// stands so near to the end that there is no room for a stop is not to set off.
class SumoHolds {
 public:
  /// @param network, drivers, log  must outlive it.
  SumoHolds(const RoadNetwork& network, SumoDrivers& drivers, SumoLog& log)
      : network_(network), drivers_(drivers), log_(log) {}

  [[nodiscard]] bool contains(const std::string& id) const {
    return stops_.contains(id) || drivers_.stands_still(id);
  }
  /// Nothing happens where a vehicle is inside a junction, or moves too close to the end to brake.
  void hold(const std::string& id);
  /// @pre contains(id)
  void release(const std::string& id);
  /// Does the vehicle stand at a stop, be it by which we hold it or its own?
  [[nodiscard]] static bool is_at_stop(const std::string& id);
  /// Is it the stop by which we hold the vehicle?
  [[nodiscard]] bool is_hold(const std::string& id, const libsumo::TraCINextStopData& stop) const;

  void forget(const std::string& id) { stops_.erase(id); }
  /// A vehicle may drive past its stop, if SUMO has it brake too late: it is held no more then.
  void forget_if_passed(const std::string& id);
  template <class Predicate>
  void forget_if(const Predicate& has_left) {
    std::erase_if(stops_, [&](const auto& entry) { return has_left(entry.first); });
  }

 private:
  struct Stop {
    std::string edge;
    int lane = 0;
    double position = 0.0;  ///< [m]
  };

  const RoadNetwork& network_;
  SumoDrivers& drivers_;
  SumoLog& log_;
  std::map<std::string, Stop> stops_;
};

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
