#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/toio/cube/protocol.hpp"
#include "tools/toio/plan/fit.hpp"

namespace mvtp {

/// Where a cube should be at one moment, as it would report it.
struct RunWaypoint {
  double time = 0.0;  ///< since the start of the run [s]
  MatPose pose;       ///< fractions of dots and degrees
  int direction = 0;  ///< 1 as the planned car drives forwards, -1 backwards, 0 at rest
  WheelUnits units;   ///< from here to the next waypoint

  friend bool operator==(const RunWaypoint&, const RunWaypoint&) = default;
};

/// "Segment `segment` may not begin before robot `robot` has left its segment `left`."
struct Requirement {
  std::size_t segment = 0;
  std::size_t robot = 0;
  std::size_t left = 0;

  friend bool operator==(const Requirement&, const Requirement&) = default;
};

/// A command to be sent at a time, if nothing ever is late.
struct TimedFrame {
  double time = 0.0;
  Write write;

  friend bool operator==(const TimedFrame&, const TimedFrame&) = default;
};

struct RunRobot {
  std::string id;
  std::string cube;  ///< name or address of the cube that drives it; empty: whichever is nearest
  std::array<std::uint8_t, 3> color = {};
  std::vector<RunWaypoint> waypoints;  ///< never empty; times rise
  /// When each segment of the plan begins [s]; the last is the rest at the goal, for ever.
  std::vector<double> segment_starts;
  std::vector<Requirement> requirements;  ///< by segment
  std::vector<TimedFrame> frames;

  friend bool operator==(const RunRobot&, const RunRobot&) = default;
};

/// Which commands move the cubes.
enum class DriveMode { kTrack, kTarget, kList };
[[nodiscard]] const char* to_string(DriveMode mode);

struct RunTiming {
  double speedup = 1.0;
  double control = 0.05;   ///< between two commands to a cube [s]
  double dead_man = 0.25;  ///< a cube that hears nothing stops after this [s]
  double accel = 0.2;      ///< [m/s^2]
  double segment = 0.5;    ///< length of a segment [s of the plan]

  friend bool operator==(const RunTiming&, const RunTiming&) = default;
};

/// All that it takes to move cubes as planned: what `mvtp toio export` writes.
struct ToioRun {
  DeskFrame desk;
  PlanFrame frame;
  RunTiming timing;
  TrackingMargins margins;
  double clearance = 0.0;  ///< least distance of two bodies without margins, on schedule [m]
  DriveMode mode = DriveMode::kTrack;
  std::vector<RunRobot> robots;
};

/// JSON; docs/toio.md has every key.
[[nodiscard]] std::string to_json(const ToioRun& run);
/// One line per frame: t_ms,robot,characteristic,hex.
[[nodiscard]] std::string to_csv(const ToioRun& run);

/// @throws InputError at the first value that is missing, of a wrong type or out of range.
[[nodiscard]] ToioRun read_run(const std::string& path);

}  // namespace mvtp
