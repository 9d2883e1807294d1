#pragma once

#include <string>
#include <vector>

#include "tools/toio/plan/run_file.hpp"

namespace mvtp {

struct ExportOptions {
  DriveMode mode = DriveMode::kTrack;
  int mtu = 23;           ///< of the cubes' link [bytes]
  double segment = 0.25;  ///< of the release graph [s of the plan]; halved where it must be
  std::vector<std::string> cubes;  ///< which cube drives which robot; empty: found at the start
};

struct Exported {
  ToioRun run;
  std::string problem;  ///< why the cubes cannot be kept apart; empty if they can
};

/// Makes all that it takes to drive a plan that fits its mat.
/// @pre fit.problem is empty; options.cubes is empty or has a name for each robot
[[nodiscard]] Exported make_run(const std::vector<PlannedRobot>& robots, double dt, const Fit& fit,
                                const FitOptions& fit_options, const ExportOptions& options);

/// The least distance between two bodies if all keep to the schedule [m]; negative if they overlap.
[[nodiscard]] double least_clearance(const ToioRun& run);

}  // namespace mvtp
