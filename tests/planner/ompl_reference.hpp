#pragma once

#include "planner/problem/pose.hpp"

namespace mvtp {

/// Length of the shortest Reeds-Shepp path as OMPL computes it [m].
[[nodiscard]] double ompl_reeds_shepp_length(const Pose& from, const Pose& to, double radius);

}  // namespace mvtp
