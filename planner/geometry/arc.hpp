#pragma once

#include <vector>

#include "planner/problem/pose.hpp"

namespace mvtp {

/// A drive of constant curvature; a wait if the length is 0.
struct Arc {
  double length = 0.0;     ///< [m], negative in reverse
  double curvature = 0.0;  ///< [1/m], positive to the left

  friend bool operator==(const Arc&, const Arc&) = default;
};

[[nodiscard]] inline bool is_wait(const Arc& arc) { return arc.length == 0.0; }

[[nodiscard]] inline Pose drive(const Pose& from, const Arc& arc) {
  return is_wait(arc) ? from : drive(from, arc.length, arc.curvature);
}

[[nodiscard]] inline Pose drive(Pose pose, const std::vector<Arc>& arcs) {
  for (const Arc& arc : arcs) pose = drive(pose, arc);
  return pose;
}

}  // namespace mvtp
