#pragma once

#include <functional>

#include "planner/search/joint_motion.hpp"

namespace mvtp {

/// Do so many robots overlap that their conflicts are better resolved by windows?
[[nodiscard]] bool needs_windows(const JointMotion& motion);

/// Resolves conflicts one window of time after the other: those before a horizon, which moves on
/// once there are none. What comes later is not worth the work as long as anything earlier may
/// change, and searches that need not look so far end sooner.
///
/// @param resolve  until nobody overlaps before the horizon; false to give up. If it takes the
///                 horizon away, it has resolved everything.
/// @pre everyone is present. Without a horizon if true.
[[nodiscard]] bool resolve_by_windows(JointMotion& motion, const std::function<bool()>& resolve);

}  // namespace mvtp
