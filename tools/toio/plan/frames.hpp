#pragma once

#include <vector>

#include "tools/toio/plan/reference.hpp"
#include "tools/toio/plan/run_file.hpp"

namespace mvtp {

/// The command that drives a cube along its reference at one moment of its clock.
[[nodiscard]] Write track_frame(const ToioRun& run, const Twist& twist);

/// The command that sends a cube to where its reference is `ahead` [m] of path from `time` on, but
/// not past a cusp nor past `limit`, a time; the last one has the angle too. The cube promises to
/// come within 15 dots of a target.
[[nodiscard]] Write target_frame(const ToioRun& run, const Reference& reference, double time,
                                 double limit, double ahead);

/// Between two commands of the mode kTarget [s], and how far ahead they aim [m].
inline constexpr double kTargetPeriod = 0.15;
inline constexpr double kTargetAhead = 0.05;

/// All commands of a robot in the mode of the run, as if it never were late. A list of targets is
/// cut so that each command fits an MTU of `mtu` bytes.
[[nodiscard]] std::vector<TimedFrame> open_loop_frames(const ToioRun& run, const RunRobot& robot,
                                                       int mtu);

}  // namespace mvtp
