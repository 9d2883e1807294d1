#pragma once

#include <vector>

#include "tools/toio/cube/cube.hpp"
#include "tools/toio/plan/run_file.hpp"

namespace mvtp {

/// The motion that a cube is to follow, on the desk, as its waypoints in the run file say it.
///
/// Times are those of the robot's own clock: the schedule if it never waits for another.
class Reference {
 public:
  struct State {
    Pose pose;
    Twist twist;
    double arc = 0.0;  ///< path made since the start, forwards and backwards [m]
  };

  Reference(const RunRobot& robot, const DeskFrame& desk);

  /// Rests at the first pose before the first waypoint, and at the last for ever.
  [[nodiscard]] State at(double time) const;
  [[nodiscard]] double end() const { return times_.back(); }
  /// The first time from `time` on at which the direction changes; end() if there is none.
  [[nodiscard]] double next_cusp(double time) const;
  /// When segments begin; the last one is the rest at the goal.
  [[nodiscard]] const std::vector<double>& segment_starts() const { return segment_starts_; }

 private:
  std::vector<double> times_;
  std::vector<Pose> poses_;
  std::vector<Twist> twists_;  ///< between waypoint k and k + 1
  std::vector<double> arcs_;
  std::vector<double> cusps_;
  std::vector<double> segment_starts_;
};

}  // namespace mvtp
