#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "coordinator/network/road_network.hpp"
#include "traci_bridge/sumo_clock.hpp"
#include "traci_bridge/sumo_drivers.hpp"
#include "traci_bridge/sumo_frame.hpp"
#include "traci_bridge/sumo_lanes.hpp"
#include "traci_bridge/sumo_routes.hpp"
#include "traci_bridge/sumo_widths.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {

/// The vehicles that go where we put them, in place of SUMO's drivers.
class SumoControlled {
 public:
  /// All of these must outlive it.
  SumoControlled(const RoadNetwork& network, SumoLanes& lanes, SumoRoutes& routes,
                 SumoDrivers& drivers, const SumoClock& clock)
      : network_(network), lanes_(lanes), routes_(routes), drivers_(drivers), clock_(clock) {}

  [[nodiscard]] bool contains(const std::string& id) const { return vehicles_.contains(id); }
  /// What it was told to drive [m/s]; nothing where somebody else drives it.
  [[nodiscard]] std::optional<double> speed(const std::string& id) const;

  /// @param front  Vehicle::front [m].
  void take_over(const std::string& id, double front);
  /// @pre contains(id), as of all that follow
  void hand_back(const std::string& id);
  /// Where it is from the next step on.
  void place(const std::string& id, const Pose& pose, double speed);
  /// It is about to be placed along these edges, the one that it is on first.
  void drive_along(const std::string& id, std::span<const std::string> edges);
  /// See Traffic. SUMO puts a vehicle onto any lane of the rest of its route that it comes near,
  /// and fails an assertion once it has been near the inside of a junction.
  void leave_road(const std::string& id);
  void enter_road(const std::string& id, const std::string& lane);

  /// Tells SUMO where all are in the next step, but those that wait.
  void send(const std::set<std::string>& waiting);
  /// After a step: those who came onto a lane again in it go on along their own routes.
  void resume_routes();
  void forget_if(const std::function<bool(const std::string&)>& has_left);

 private:
  /// A vehicle is put there again in each step until it is put elsewhere, since SUMO loses a
  /// vehicle that is off the road and not put anywhere in a step.
  struct Controlled {
    double front = 0.0;  ///< Vehicle::front [m]
    SumoPosition position;
    double speed = 0.0;  ///< [m/s]
    int speed_mode = 0;  ///< to restore
    int lane_change_mode = 0;
    std::vector<std::string> rest_of_route;  ///< edges, of a vehicle that has left the road
    bool enters = false;                     ///< it is to be on the first of them again, in
    int lane_index = -1;                     ///< this lane
  };

  const Lane* settle(const std::string& id, double speed);
  void cut_route(const std::string& id, std::size_t length);
  static void put_onto_route(const std::string& id, const Controlled& vehicle);

  const RoadNetwork& network_;
  SumoLanes& lanes_;
  SumoRoutes& routes_;
  SumoDrivers& drivers_;
  const SumoClock& clock_;
  SumoWidths widths_;
  std::map<std::string, Controlled> vehicles_;
  std::set<std::string> unrestored_;  ///< handed back, but SUMO does not know the whole route yet
};

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
