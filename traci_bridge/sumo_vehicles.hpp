#pragma once

#include <limits>
#include <map>
#include <string>

#include "coordinator/traffic.hpp"
#include "traci_bridge/sumo_api.hpp"
#include "traci_bridge/sumo_controlled.hpp"
#include "traci_bridge/sumo_holds.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {

/// Reads the states of vehicles; asks only once for what does not change.
class SumoVehicles {
 public:
  /// @param controlled, holds  must outlive it.
  SumoVehicles(const SumoControlled& controlled, const SumoHolds& holds)
      : controlled_(controlled), holds_(holds) {}

  /// @param state  becomes that of the vehicle.
  void read(std::string id, VehicleState& state);
  /// Vehicle::front [m].
  [[nodiscard]] double front(const std::string& id) { return known(id).front; }
  void forget(const std::string& id) { known_.erase(id); }

 private:
  struct Constant {
    std::string type;
    double front = 0.0;  ///< Vehicle::front [m]
    double speed_factor = 1.0;
    double top_speed = std::numeric_limits<double>::infinity();  ///< VehicleState::top_speed
    std::string lane = {};                                       ///< where that was last looked up
  };
  [[nodiscard]] Constant& known(const std::string& id);
  static void look_up_top_speed(const std::string& id, const std::string& lane, Constant& vehicle);

  const SumoControlled& controlled_;
  const SumoHolds& holds_;
  std::map<std::string, Constant> known_;
};

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
