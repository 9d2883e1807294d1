#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "planner/geometry/arc.hpp"

namespace mvtp {

// Reeds-Shepp paths outside of inner loops, by OMPL. What runs in inner loops is
// motion/reeds_shepp.

/// Length of the shortest path of a car without obstacles [m]. @pre radius > 0 [m]
[[nodiscard]] double shortest_length(const Pose& from, const Pose& to, double radius);

struct SamplingOptions {
  int iterations = 3000;  ///< > 0; of RRT-Connect: samples to which the two trees grow
  double range = 1.0;     ///< [m] by which a tree grows at most
  double around = 10.0;   ///< [m] about the start and the goal, where most samples are drawn
  double cusp = 3.0;      ///< [m] that a change of direction counts as
  std::uint64_t seed = 0;
};

/// May the car drive this arc, of at most kLongestPiece? Asked for every arc of a path, so a path
/// is as free between its samples as the answer says.
using ArcCheck = std::function<bool(const Pose& from, const Arc& arc)>;
inline constexpr double kLongestPiece = 1.0;  ///< [m]

/// A path of one car among obstacles that a lattice is too coarse for: out of tight slots, through
/// clutter. RRT-Connect (Kuffner & LaValle 2000) from both ends, joined by Reeds-Shepp paths, and
/// then the shortest path over its vertices.
///
/// The same arguments give the same path: samples are drawn here, and work is counted, not timed.
/// @return arcs of at most kLongestPiece that end at `goal` within 1e-9 radii; nullopt if none was
///         found; empty if start and goal are the same
/// @param radius smallest turning radius [m] > 0
/// @param ground [m] the rear axle stays in 0 <= x <= ground.x, 0 <= y <= ground.y
[[nodiscard]] std::optional<std::vector<Arc>> plan_by_sampling(const Pose& start, const Pose& goal,
                                                               double radius, const Point& ground,
                                                               const SamplingOptions& options,
                                                               const ArcCheck& is_free);

}  // namespace mvtp
