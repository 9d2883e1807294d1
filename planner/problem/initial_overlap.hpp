#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "planner/problem/instance.hpp"

namespace mvtp {

/// An agent that overlaps an obstacle or another agent where it starts, or where it is to end, by
/// more than a touch.
///
/// Some published instances have such places. Under InitialOverlap::kAllow the two are exempt from
/// the rule of collision: at the start up to the end of the first step after which they are apart,
/// at the goal from the last step on before which they were apart, and never more deeply than at
/// that place.
struct OverlappingPlace {
  enum class With { kObstacle, kAgent };

  bool at_goal = false;   ///< else at the start
  std::size_t agent = 0;  ///< of two agents the one that comes later in the file
  With with = With::kObstacle;
  std::size_t object = 0;  ///< circles first, then polygons; or the other agent
  double depth = 0.0;      ///< [m]

  friend bool operator==(const OverlappingPlace&, const OverlappingPlace&) = default;
};

/// All of them: starts before goals, obstacles before agents, then in the order of the file.
[[nodiscard]] std::vector<OverlappingPlace> find_overlapping_places(const Instance& instance);

/// "obstacles[7]" or "polygons[2]".
[[nodiscard]] std::string obstacle_name(const Map& map, std::size_t object);
/// A depth [m] with two digits behind the point, as far as they say something.
[[nodiscard]] std::string depth_text(double depth);

/// What is exempt from the rule of collision in this instance, for people: "start of agent3 in
/// obstacles[7] by 0.02 m". Empty under InitialOverlap::kRefuse.
[[nodiscard]] std::vector<std::string> exemptions_of(const Instance& instance);

}  // namespace mvtp
