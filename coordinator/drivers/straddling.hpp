#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/drivers/lane_keeping.hpp"
#include "coordinator/network/lane_graph.hpp"
#include "coordinator/traffic.hpp"

namespace mvtp {

/// Shows drivers the bodies of vehicles under control that are across lanes, or are about to be:
/// who changes lanes slowly, or turns off. SUMO's drivers see a vehicle that is placed from outside
/// only on the lane that its front bumper is on [sumo#7496]; those behind it on the others would
/// drive into its tail, and those beside would change lanes into its side. The first are kept from
/// driving faster than they could stop behind it, as behind any leader; the others are kept in
/// their lanes, and so are those inside a junction where somebody under control is near.
class Straddling {
 public:
  /// Where a vehicle under control will be soon, and how fast; none: it has a driver.
  using PosesSoon = std::function<std::vector<PlannedPose>(const std::string&)>;
  /// How much earlier than with full braking a driver has to begin to stop [s].
  using Reaction = std::function<double(const VehicleState&)>;
  using TypeOf = std::function<const VehicleType&(const std::string&)>;
  /// The normal lane that a vehicle inside a junction comes from; LaneGraph::kNone: not known.
  using CameFrom = std::function<int(const std::string&)>;

  Straddling(Traffic& traffic, LaneKeeping& keeping, const LaneGraph& graph, PosesSoon poses_soon,
             Reaction reaction, TypeOf type_of, CameFrom came_from);

  /// To be called before each step.
  void show();
  /// Where on its lane the front of a driver stops behind somebody who stood there at the last
  /// show(), stands already, or comes to rest there [m]; none: nobody's tail is ahead of it.
  [[nodiscard]] std::optional<double> stop_position(const VehicleState& driver) const;

 private:
  /// A point of a body on a lane that its front is not on.
  struct Tail {
    double along = 0.0;  ///< [m] from the start of the lane
    double aside = 0.0;  ///< [m] from its middle, for a rear that of the nearest point of the body
    double speed = 0.0;  ///< [m/s] along the lane
    double rear = 0.0;   ///< [m] where the body begins
  };
  [[nodiscard]] bool is_clear(const Pose& pose, const Vehicle& body, int lane, int from) const;
  void find_tails(const VehicleState& v, const PlannedPose& at);
  void add_body(const std::vector<Point>& body, int lane, double speed);
  [[nodiscard]] bool enters_junction(const VehicleState& driver, int lane) const;
  [[nodiscard]] bool is_near_one(const VehicleState& driver) const;
  [[nodiscard]] bool is_beside_one(const VehicleState& driver) const;
  [[nodiscard]] std::vector<Tail> tails_ahead(const VehicleState& driver) const;
  [[nodiscard]] double safe_speed(const VehicleState& driver, const Tail& tail) const;
  [[nodiscard]] double most_speed(const VehicleState& driver) const;

  Traffic& traffic_;
  LaneKeeping& keeping_;
  const LaneGraph& graph_;
  PosesSoon poses_soon_;
  Reaction reaction_;
  TypeOf type_of_;
  CameFrom came_from_;
  std::vector<Pose> controlled_;                      ///< who is under control
  std::map<std::string, std::vector<Tail>> tails_;    ///< by lane
  std::map<std::string, std::vector<double>> sides_;  ///< of bodies on or near a lane, along it [m]
  std::set<std::string> capped_;                      ///< drivers
};

}  // namespace mvtp
