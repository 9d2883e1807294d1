#pragma once

#include <span>
#include <string>

#include "tools/report/run_folders.hpp"
#include "tools/report/time_space.hpp"

namespace mvtp {

/// What report.py draws of runs: arrivals by the minute, the time-space diagram of a movement where
/// runs have a replay, and the distributions of encounters.
/// @throws InputError as time_space_of()
[[nodiscard]] std::string runs_to_json(std::span<const ReportedRun> runs,
                                       const TimeSpaceRequest& request);

}  // namespace mvtp
