#pragma once

#include <cstdint>
#include <vector>

#include "planner/road/profile_planner.hpp"

namespace mvtp {

/// Who has to brake before the next decision because somebody has appeared: those who would meet a
/// forecast of the scene if they followed their plans for one more decision, and whoever would meet
/// them when they brake. Who brakes fully already is not among them.
///
/// @param plan  of every vehicle of the scene.
/// @return keys, ascending.
[[nodiscard]] std::vector<std::int64_t> who_must_brake(const RoadScene& scene,
                                                       const JointPlan& plan,
                                                       const ProfileOptions& options);

}  // namespace mvtp
