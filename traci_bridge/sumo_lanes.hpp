#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coordinator/network/road_network.hpp"
#include "traci_bridge/sumo_api.hpp"
#include "traci_bridge/sumo_log.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {

/// Keeps SUMO's idea of where the vehicles are that we place.
class SumoLanes {
 public:
  /// @param network, log  must outlive it.
  SumoLanes(const RoadNetwork& network, SumoLog& log);

  /// Puts a vehicle that we place onto the lane again where it is already, as SUMO would.
  ///
  /// As long as a placed vehicle stays on its lane, SUMO does not look again on which lanes its
  /// tail is, and inside a junction it may take an edge further on or back for the one before it.
  /// Once the vehicle or a follower of it asks, an assertion fails. SUMO looks when a vehicle
  /// enters a lane, so it goes onto another one first. Only where need be: each time, SUMO counts
  /// the lane once more as driven (routeLength of its tripinfo).
  /// @param rest  of its route.
  /// @param speed  [m/s] in the next step; see where_tail_is_found().
  /// @return its lane; nullptr off the road
  const Lane* settle(const std::string& id, std::span<const std::string> rest, double speed,
                     double step_length);

 private:
  struct Place {
    std::string lane;
    double position = 0.0;  ///< [m]
  };

  void note_before(const std::string& lane, const Lane& before);
  [[nodiscard]] bool has_stale_tail(const std::string& id, const Lane& lane, double position,
                                    double step_length) const;
  [[nodiscard]] std::vector<double> lengths_before(const Lane& lane, double reach) const;
  [[nodiscard]] bool is_misplaced(const Lane& lane, std::span<const std::string> rest) const;
  [[nodiscard]] std::optional<Place> place_beside(const Lane& lane, double position,
                                                  std::span<const std::string> rest) const;

  const RoadNetwork& network_;
  SumoLog& log_;
  std::multimap<std::string, const Connection*> leaving_;  ///< by the lane they leave
  std::map<std::string, const Connection*> inside_;        ///< by internal lane
  std::map<std::string, const Lane*> shortest_before_;     ///< of those that lead onto each lane
};

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
