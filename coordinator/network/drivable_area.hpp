#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "coordinator/network/road_network.hpp"
#include "planner/problem/interruption.hpp"
#include "planner/problem/parking_lot.hpp"

namespace mvtp {

/// The ground that vehicles may use: the strips of all drivable lanes, the seams between lanes of
/// one edge, the junctions' areas, and the ground of parking lots without what stands on it.
class DrivableArea {
 public:
  /// The ground of motor vehicles: the road.
  explicit DrivableArea(const RoadNetwork& network, std::span<const ParkingLot> lots = {})
      : DrivableArea(network, lots, "", never_interrupted) {}
  /// The road, and the lanes that are open to this class without being road, e.g. bicycle lanes.
  /// @param vehicle_class  SUMO's vClass word; empty: no lanes but the road
  /// @param point  called for every lane
  DrivableArea(const RoadNetwork& network, std::span<const ParkingLot> lots,
               const std::string& vehicle_class, const InterruptionPoint& point);

  /// Bodies do not touch this ground, road or not.
  void keep_off(Polygon ground) { solid_.push_back(std::move(ground)); }

  /// Is `p` on the road, or at most `tolerance` [m] beside it?
  [[nodiscard]] bool contains(const Point& p, double tolerance) const;

  /// The share of the border of a vehicle's footprint that is off the road, in [0, 1]; 0 means that
  /// the whole footprint is on it (sampled at most 1 m apart, corners included). 1 if it touches
  /// what stands on a parking lot, or ground to keep off.
  [[nodiscard]] double share_outside(const Pose& rear_axle, const Vehicle& body,
                                     double tolerance) const;

  /// Does the footprint touch what stands on a parking lot, or ground to keep off?
  [[nodiscard]] bool touches_solid(const Pose& rear_axle, const Vehicle& body) const;

  /// What it takes of memory: cells of the look-up grid, each as often as something is near it.
  [[nodiscard]] std::size_t entries() const;

 private:
  struct Strip {
    Point a, b;
    double half_width;
  };

  void add_strip(const Strip& strip);
  void add_lane(const Lane& lane);
  void add_seam(const Lane& right, const Lane& left);
  void add_polygon(const Polygon& polygon);
  [[nodiscard]] bool is_in(std::int32_t item, const Point& p, double tolerance) const;
  /// @param item  a strip to look at first; the one that `p` is on, if there is any.
  [[nodiscard]] bool contains(const Point& p, double tolerance, std::int32_t& item) const;
  void register_box(Point low, Point high, std::int32_t item);
  [[nodiscard]] static std::int64_t cell_key(std::int64_t column, std::int64_t row);

  std::vector<Strip> strips_;
  std::vector<Polygon> polygons_;
  std::vector<Polygon> solid_;  ///< what stands on parking lots, and ground to keep off
  /// Items near each cell: strip i as i, polygon j as -1 - j. Looked up only, never iterated.
  std::unordered_map<std::int64_t, std::vector<std::int32_t>> cells_;
};

}  // namespace mvtp
