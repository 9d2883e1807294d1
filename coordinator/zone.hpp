#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "coordinator/drivable_area.hpp"
#include "coordinator/traffic.hpp"
#include "planner/motion/path_library.hpp"

namespace mvtp {

struct ZoneOptions {
  double radius = 80.0;            ///< [m] before the stop line at which vehicles are taken over
  double exit = 60.0;              ///< [m] behind the junction where they are handed back
  double max_lateral_accel = 0.0;  ///< [m/s^2]; 0: only the limits of the lanes
  Margins margins;
};

/// A way through the zone for one type of vehicle: its lanes, and the smooth path of its rear axle.
struct Movement {
  std::vector<std::string> lanes;      ///< in driving order, internal lanes included
  std::string type;                    ///< VehicleType::id
  int path = 0;                        ///< in the PathLibrary
  std::vector<double> lane_limits;     ///< [m/s] per GuidePath::kSpacing of the rear axle's path
  std::vector<double> lateral_limits;  ///< [m/s] likewise, from the curvature
  std::map<std::string, double>
      lane_starts;     ///< rear axle when the front bumper enters the lane [m]
  int entry_lane = 0;  ///< number of the first and of the last lane
  int exit_lane = 0;
  double s_entry_line = 0.0;  ///< rear axle when the front bumper is at the stop line [m]
  double s_exit_lane = 0.0;   ///< rear axle when the front bumper leaves the last junction [m]
  double s_handback = 0.0;    ///< [m]
  double s_end = 0.0;         ///< [m] where the path ends
};

/// The junctions that are coordinated together, and the ways through them.
///
/// A junction's zone begins `radius` before each stop line and ends `exit` behind the junction.
/// Where a lane between two of the junctions is covered by both, vehicles stay under control.
class Zone {
 public:
  /// @throws InputError if a junction is not in the network.
  Zone(const RoadNetwork& network, const DrivableArea& area, const std::set<std::string>& junctions,
       const ZoneOptions& options);

  [[nodiscard]] const PathLibrary& library() const { return library_; }
  [[nodiscard]] const Movement& movement(int m) const { return movements_[std::size_t(m)]; }

  /// Is the vehicle on an approach, within the radius?
  [[nodiscard]] bool is_approaching(const VehicleState& vehicle) const;
  /// Is this lane one of an approach, an exit or the inside of the zone?
  [[nodiscard]] bool touches(const std::string& lane) const { return zone_lanes_.contains(lane); }

  /// The movement of a vehicle on an approach along its route; nullopt if its lane does not lead
  /// where it wants to go. Built at the first use of each.
  [[nodiscard]] std::optional<int> movement_for(const VehicleState& vehicle,
                                                std::span<const std::string> route,
                                                const VehicleType& type);
  /// Any movement of this type that uses `lane`; nullopt if no movement does.
  [[nodiscard]] std::optional<int> movement_over(const std::string& lane, const VehicleType& type);

 private:
  using Lanes = std::vector<std::string>;

  [[nodiscard]] const Lane& lane(const std::string& id) const { return network_.lanes.at(id); }
  [[nodiscard]] bool extend(Lanes& lanes, std::span<const std::string> route, double beyond) const;
  [[nodiscard]] bool leads_on(const std::string& lane, std::span<const std::string> route) const;
  int movement_along(const Lanes& lanes, const VehicleType& type);
  [[nodiscard]] std::string exit_lane_of(const Lanes& lanes) const;
  [[nodiscard]] double length_behind(const Lanes& lanes, const std::string& exit) const;
  [[nodiscard]] double lateral_limit(const GuidePath& path, double s) const;
  Movement build(const Lanes& lanes, const VehicleType& type);
  int number_of(const std::string& lane);

  const RoadNetwork& network_;
  const DrivableArea& area_;
  std::set<std::string> junctions_;
  ZoneOptions options_;
  std::map<std::string, std::vector<const Connection*>> connections_;  ///< by the lane they leave
  std::map<std::string, std::string> junction_ahead_;  ///< of each normal lane with connections
  std::set<std::string> zone_lanes_;
  std::map<std::string, int> lane_numbers_;
  PathLibrary library_;
  std::vector<Movement> movements_;
  std::map<std::pair<Lanes, std::string>, int> known_;
};

/// The path of the rear axle along a lane centre line for this body: smooth enough for its turning
/// circle and, where the body is long, wide enough to keep its footprint on the road.
[[nodiscard]] GuidePath make_guide_path(std::span<const Point> centre_line, const Vehicle& body,
                                        const DrivableArea& area);

}  // namespace mvtp
