#pragma once

#include <span>
#include <vector>

#include "planner/motion/arc_trajectory.hpp"

namespace mvtp {

/// Where robots are, one circle per robot and macro step of time: the broad phase of collision
/// tests.
///
/// A macro step is scanned from end to end, some ten nanoseconds per hundred robots; circles lie in
/// rows of equal length, those of absent robots far away.
class Occupancy {
 public:
  Occupancy(int robots, TimeGrid time);

  /// near() may write so many entries more than there are robots.
  static constexpr std::size_t kPadding = 16;

  /// Robot i moves along `trajectory` from now on, in place of what it did before.
  void place(int i, const ArcTrajectory& trajectory, const BoxShape& shape);
  void remove(int i);

  /// The robots whose circles overlap the given one during a macro step, in ascending order;
  /// `found` has room for all and kPadding more. Later macro steps than horizon() are like the last
  /// one: all robots rest or have departed.
  /// @return how many
  int near(int macro_step, float x, float y, float radius, int* found) const;

  /// Does robot i's circle overlap the given one during a macro step?
  [[nodiscard]] bool overlaps(int macro_step, int i, float x, float y, float radius) const {
    const std::size_t here = at(std::min(macro_step, rows_ - 1), i);
    const float dx = x_[here] - x;
    const float dy = y_[here] - y;
    const float reach = radius_[here] + radius;
    return dx * dx + dy * dy < reach * reach;
  }
  /// What robot i does during the macro step, more closely. @pre it is present
  struct MacroStepSweep {
    SweptBox swept;
    float travel = 0.0F;  ///< no point of it moves further between two time steps [m]
  };
  [[nodiscard]] const MacroStepSweep& sweep(int macro_step, int i) const {
    return sweeps_[at(std::min(macro_step, rows_ - 1), i)];
  }

  /// The number of macro steps after which every robot rests or has departed.
  [[nodiscard]] int horizon() const { return rows_ - 1; }

 private:
  [[nodiscard]] std::size_t at(int macro_step, int i) const {
    return std::size_t(macro_step) * std::size_t(stride_) + std::size_t(i);
  }
  void extend(int rows);
  void remove(int i, int macro_step);

  TimeGrid time_;
  int stride_;
  int rows_ = 0;
  std::vector<float> x_;
  std::vector<float> y_;
  std::vector<float> radius_;
  std::vector<MacroStepSweep> sweeps_;
};

}  // namespace mvtp
