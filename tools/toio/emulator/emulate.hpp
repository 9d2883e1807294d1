#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "tools/toio/plan/player.hpp"

namespace mvtp {

/// What may go wrong between the player and the cubes.
struct EmulateOptions {
  double delay = 0.13;             ///< from a command to the report of what it did, in the mean [s]
  double jitter = 0.3;             ///< the delay varies by this share of it, evenly
  double loss = 0.0;               ///< share of the commands and of the reports that get lost
  double stalls_per_minute = 0.0;  ///< of each cube's wheels, at random
  double shortest_stall = 1.0;     ///< [s]
  double longest_stall = 5.0;      ///< [s]
  double wheel_error = 0.03;       ///< of each wheel's speed, evenly up to this share
  double placement = 0.002;        ///< of the cubes at the start, evenly up to this [m]
  double placement_turn = 0.05;    ///< and this [rad]
  std::uint64_t seed = 0;
  PlayerOptions player;
};

/// How an emulated run went; lengths in metres, times in seconds.
struct EmulateReport {
  bool finished = false;  ///< every robot arrived
  double duration = 0.0;  ///< until the last arrival, or the end
  double least_clearance = std::numeric_limits<double>::infinity();  ///< of the true bodies
  std::vector<std::string> touching;  ///< pairs of robots that touched: "agent0 and agent2"
  int stalls = 0;
  std::vector<RobotOutcome> robots;
  std::vector<std::vector<Pose>> tracks;  ///< by robot, every 0.05 s: the true axle on the desk

  [[nodiscard]] double waited() const;
  [[nodiscard]] double most_lateral() const;
  [[nodiscard]] double most_along() const;
};

/// Drives a run on cubes that exist only here, through the very frames that real ones get.
/// Same run and options, same report.
[[nodiscard]] EmulateReport emulate(const ToioRun& run, const EmulateOptions& options);

}  // namespace mvtp
