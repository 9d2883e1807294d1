#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "planner/geometry/arc.hpp"
#include "planner/geometry/moving_box.hpp"

namespace mvtp {

/// How fine time is, and how coarse the search looks at it.
struct TimeGrid {
  double dt = 0.1;  ///< between two instants [s]: one step of the plan
  int bucket = 14;  ///< instants per bucket: one action of the search

  [[nodiscard]] double bucket_duration() const { return dt * bucket; }
};

/// One robot's motion: one arc per instant from time 0 on, then at rest for ever, or departed.
///
/// The arcs are exact; the boxes, in single precision, are what collision tests read.
class TimedTrack {
 public:
  TimedTrack() = default;
  /// @param padding  so many boxes at rest follow the last one: the size of a bucket.
  /// @param leaves   the robot has departed after the bucket in which it arrives
  TimedTrack(const Vehicle& vehicle, const Pose& start, std::vector<Arc> steps, int padding,
             bool leaves = false);

  /// The instant from which on the robot rests.
  [[nodiscard]] int arrival() const { return int(steps_.size()); }
  [[nodiscard]] const std::vector<Arc>& steps() const { return steps_; }
  [[nodiscard]] const Pose& start() const { return start_; }
  /// The rear axle at instant t >= 0.
  [[nodiscard]] Pose pose(int t) const;

  static constexpr int kNever = std::numeric_limits<int>::max();
  /// The instant from which on the robot is nowhere: the end of a bucket. kNever: it stays.
  [[nodiscard]] int departure() const { return departure_; }

  /// Boxes from instant t on: `padding` + 1 of them may be read. @pre 0 <= t < departure()
  [[nodiscard]] const BoxPose* boxes(int t) const { return boxes_.data() + std::min(t, end_); }
  [[nodiscard]] bool empty() const { return boxes_.empty(); }

 private:
  Pose start_;
  std::vector<Arc> steps_;
  std::vector<Pose> poses_;  ///< at every kStride-th instant
  std::vector<BoxPose> boxes_;
  int end_ = 0;  ///< from this box on all are the same
  int departure_ = kNever;
};

}  // namespace mvtp
