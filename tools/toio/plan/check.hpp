#pragma once

#include <string>
#include <vector>

#include "tools/toio/plan/run_file.hpp"

namespace mvtp {

/// What is wrong with a run, one line each; empty if cubes may drive it.
///
/// Judged anew from the file alone, with the referee's geometry and not that of the release graph:
/// the bodies with their margins stay on the mat, and the sensor on its print; speeds and
/// accelerations are those a cube has; whoever would be blocking another waits for it (complete),
/// and only for what is earlier in the plan (acyclic); the frames decode to what the waypoints say.
[[nodiscard]] std::vector<std::string> find_problems(const ToioRun& run);

/// Reads a run for driving it in `mode`.
/// @throws InputError if the file is bad, cubes may not drive it, or its margins are too small for
/// `mode`.
[[nodiscard]] ToioRun read_drivable_run(const std::string& path, DriveMode mode);

}  // namespace mvtp
