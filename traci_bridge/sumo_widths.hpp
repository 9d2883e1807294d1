#pragma once

#include <functional>
#include <map>
#include <string>

#include "coordinator/network/road_network.hpp"
#include "traci_bridge/sumo_api.hpp"
#include "traci_bridge/sumo_frame.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {

/// Keeps SUMO from losing placed vehicles that swing wide in their turns.
///
/// A vehicle whose front is further beside the middle of its lane than half the widths of both is
/// off the road for SUMO: on no lane, so that no driver sees it, and vehicles depart right before
/// it. While it is there SUMO takes it for as wide as need be. Its body of type TYPE is TYPE@ID
/// from then on.
class SumoWidths {
 public:
  /// Before the vehicle is placed there. @param lane  on which it is now
  void widen(const std::string& id, const Lane& lane, const SumoPosition& front);
  /// As wide as it is.
  void restore(const std::string& id);
  void forget_if(const std::function<bool(const std::string&)>& has_left);

 private:
  struct Width {
    double own = 0.0;    ///< [m]
    double shown = 0.0;  ///< [m]
  };
  void show(const std::string& id, Width& width, double shown);

  std::map<std::string, Width> widths_;
};

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
