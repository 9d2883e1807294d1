#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/toio/device/bluetooth.hpp"
#include "tools/toio/plan/player.hpp"

namespace mvtp {

struct LiveOptions {
  PlayerOptions player;
  double scan_time = 10.0;             ///< [s]
  double place_time = 120.0;           ///< for putting the cubes on their starts [s]
  double place_tolerance = 0.005;      ///< of a cube at its start [m]
  double place_turn_tolerance = 0.14;  ///< [rad]
};

/// What live runs tell their user while they go on.
struct LiveHooks {
  std::function<void(const std::string&)> say;  ///< one line
  /// Everything sent and heard, one JSON object per line; may be empty.
  std::function<void(const std::string&)> log;
  /// True once for each time that the user asks to pause, or to go on.
  std::function<bool()> pause_asked;
};

struct LiveOutcome {
  bool finished = false;
  std::string reason;  ///< why not; empty if finished
  double duration = 0.0;
  std::vector<RobotOutcome> robots;
};

/// Drives a run on real cubes: finds and connects them, checks firmware and battery, waits until
/// each is on its start (their lamps turn from red to green), drives, stops.
///
/// However it ends, by arrival, fault, exception or Interrupted, every cube that is connected is
/// told to stop before it is let go. A button of any cube pauses all, and lets them go on.
/// @throws BluetoothError if the cubes cannot be had; Interrupted.
[[nodiscard]] LiveOutcome run_live(Bluetooth& bluetooth, const ToioRun& run,
                                   const LiveOptions& options, const LiveHooks& hooks);

/// What a measurement on one cube settles.
struct Calibration {
  double center_to_axle = 0.0;  ///< [m]
  double speed_per_unit = 0.0;  ///< [m/s]
  double lag = 0.0;             ///< [s]
};

/// Measures a cube that stands on `mat` with 150 mm of room around it: spins, then drives to and
/// fro four times. `name` is its name or address; empty: the only one.
/// @throws BluetoothError if it cannot be had or leaves the mat; Interrupted.
[[nodiscard]] Calibration calibrate(Bluetooth& bluetooth, const Mat& mat, const std::string& name,
                                    const LiveHooks& hooks);

}  // namespace mvtp
