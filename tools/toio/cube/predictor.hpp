#pragma once

#include <deque>
#include <optional>

#include "planner/problem/pose.hpp"
#include "tools/toio/cube/cube.hpp"

namespace mvtp {

/// Where a cube will be once the command that is about to be sent takes effect.
///
/// What a cube reports is old, and what was sent to it takes time: together the lag. The commands
/// of the last `lag` seconds have not shown yet in the latest report; replaying them from there on
/// gives the pose to steer from. Without it a loop at 20 Hz swings (Smith predictor).
class Predictor {
 public:
  /// @param lag from sending a command to hearing of the motion that it began [s].
  Predictor(const Cube& cube, Facing facing, double lag);

  /// A command was sent. Times never fall.
  void sent(const WheelUnits& units, double now);
  /// The cube's axle was reported at this pose of the desk.
  void measured(const Pose& pose, double now);
  /// nullopt before the first report.
  [[nodiscard]] std::optional<Pose> at(double now) const;

 private:
  /// The wheels from one command on: they near its speeds as exp(-t / kMotorTime).
  struct Phase {
    double begin = 0.0;
    Twist target;
    Twist at_begin;
  };
  [[nodiscard]] static Twist speed(const Phase& phase, double time);

  Cube cube_;
  Facing facing_;
  double lag_;
  std::deque<Phase> phases_;
  std::optional<Pose> measured_;
  double measured_at_ = 0.0;
};

/// Time constant of the motors [s]. Source: toio SDK for Unity, docs_EN/sys_simulator.md.
inline constexpr double kMotorTime = 0.04;

}  // namespace mvtp
