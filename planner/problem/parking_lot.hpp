#pragma once

#include <string>
#include <vector>

#include "planner/problem/instance.hpp"
#include "planner/problem/pose.hpp"

namespace mvtp {

/// Where one vehicle may park: a rectangle, open towards an aisle at one of its short sides.
struct ParkingSlot {
  std::string id;
  Pose middle;          ///< of the rectangle; theta points from the aisle into the slot
  double length = 5.0;  ///< along theta [m]
  double width = 2.5;   ///< [m]
};

/// The straight piece of a lane that lies on a lot's ground.
struct LotLane {
  std::string lane;     ///< id
  Pose begin;           ///< of the piece, on the centre line; theta is the driving direction
  double length = 0.0;  ///< of the piece [m]
  double offset = 0.0;  ///< where on the lane the piece begins [m]
};

/// A strip on which people walk across the lot.
struct Footpath {
  std::vector<Point> line;  ///< its middle
  double width = 2.0;       ///< [m]
};

/// An open parking lot: ground that vehicles may use as they like, slots, and the lanes by which
/// they come (each ends on the ground) and go (each begins on it).
struct ParkingLot {
  std::string id;
  Polygon ground;                  ///< the bodies stay inside, but where lanes cross its border
  std::vector<Polygon> obstacles;  ///< islands, pillars, walls on the ground
  std::vector<ParkingSlot> slots;
  std::vector<LotLane> entries;
  std::vector<LotLane> exits;
  std::vector<Footpath> footpaths;
};

}  // namespace mvtp
