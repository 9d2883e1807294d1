#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "planner/geometry/arc.hpp"
#include "planner/geometry/moving_box.hpp"

namespace mvtp {

/// How fine time is, and how coarse the search looks at it.
struct TimeGrid {
  double dt = 0.1;      ///< between two time steps [s]: one step of the plan
  int macro_step = 14;  ///< time steps per macro step: one motion primitive of the search

  [[nodiscard]] double macro_step_duration() const { return dt * macro_step; }
};

/// Arcs of any length, cut into pieces of a time step at most.
/// @param step_length  driven in one time step at full speed [m] > 0
[[nodiscard]] std::vector<Arc> by_time_steps(const std::vector<Arc>& arcs, double step_length);

/// One robot's motion: one arc per time step from time 0 on, then at rest for ever, or departed.
///
/// The arcs are exact; the boxes, in single precision, are what collision tests read. Copies share
/// them all: a long trajectory takes some hundred kB.
class ArcTrajectory {
 public:
  ArcTrajectory() = default;
  /// @param padding  so many boxes at rest follow the last one: the size of a macro step.
  /// @param leaves   the robot has departed after the macro step in which it arrives
  ArcTrajectory(const Vehicle& vehicle, const Pose& start, std::vector<Arc> steps, int padding,
                bool leaves = false);

  /// The time step from which on the robot rests.
  [[nodiscard]] int arrival() const { return int(steps().size()); }
  [[nodiscard]] const std::vector<Arc>& steps() const { return course_->steps; }
  [[nodiscard]] const Pose& start() const { return start_; }
  /// The rear axle at time step t >= 0.
  [[nodiscard]] Pose pose(int t) const;

  static constexpr int kNever = std::numeric_limits<int>::max();
  /// The time step from which on the robot is nowhere: the end of a macro step. kNever: it stays.
  [[nodiscard]] int departure() const { return departure_; }

  /// Boxes from time step t on: `padding` + 1 of them may be read. @pre 0 <= t < departure()
  [[nodiscard]] const BoxPose* boxes(int t) const { return boxes_ + std::min(t, end_); }
  [[nodiscard]] bool empty() const { return boxes_ == nullptr; }

 private:
  struct Course {
    std::vector<Arc> steps;
    std::vector<Pose> poses;  ///< at every kStride-th time step
    std::vector<BoxPose> boxes;
  };
  static const std::shared_ptr<const Course>& no_course();

  Pose start_;
  std::shared_ptr<const Course> course_ = no_course();
  const BoxPose* boxes_ = nullptr;  ///< those of the course
  int end_ = 0;                     ///< from this box on all are the same
  int departure_ = kNever;
};

}  // namespace mvtp
