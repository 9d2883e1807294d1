#pragma once

#include <span>
#include <vector>

#include "planner/road/contact_table.hpp"

namespace mvtp {

/// What a vehicle has to itself on a junction while it is there, beside the ground under its body.
enum class Reservation {
  kNone,          ///< nothing more
  kTiles,         ///< every tile of a grid that its body touches [Dresner, Stone, AIM, 2008]
  kConflictArea,  ///< towards each other path: all of the ground where the two meet
  kJunction,      ///< the whole junction, but for those who follow it from its own lane
};

/// Where a path leads over a junction.
struct JunctionStretch {
  int junction = 0;
  int approach = 0;   ///< the lane from which it comes
  double from = 0.0;  ///< [m] rear axle, when the front bumper is at the line
  double to = 0.0;    ///< [m] rear axle, when the tail is out
};

/// Edge of the tiles of kTiles [m].
inline constexpr double kTile = 1.0;

/// A path with what its body covers, and its junctions.
struct ReservingPath {
  const SweptPath* swept = nullptr;
  std::span<const JunctionStretch> stretches;
};

/// Pairs of positions that a reservation forbids to a vehicle on path A and one on path B while
/// both are on one junction.
/// @param bodies  where their bodies meet, for A and B in this order.
[[nodiscard]] ContactTable reserved_ground(Reservation reservation, const ReservingPath& a,
                                           const ReservingPath& b, const ContactTable& bodies);

}  // namespace mvtp
