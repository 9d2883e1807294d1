#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "planner/motion/stepped_car.hpp"

namespace mvtp {

/// The sweeps of a robot's steps, and then its footprint at rest for ever.
class MovingObstacle {
 public:
  MovingObstacle(const SteppedCar& car, Pose start, const std::vector<Arc>& steps) {
    sweeps_.reserve(steps.size() + 1);
    for (const Arc& arc : steps) {
      sweeps_.push_back(car.sweep(start, arc));
      start = drive(start, arc);
    }
    sweeps_.push_back(car.sweep(start, {}));
  }

  /// Its steps from t on, at most so many; then at rest. @pre t >= 0, steps > 0
  [[nodiscard]] MovingObstacle part(int t, int steps) const {
    const int first = std::min(t, makespan());
    const int last = std::min(makespan(), first + steps);
    return MovingObstacle({sweeps_.begin() + first, sweeps_.begin() + last + 1});
  }

  /// The number of steps until it rests.
  [[nodiscard]] int makespan() const { return int(sweeps_.size()) - 1; }
  /// The sweep of step t, from time t to t + 1. @pre t >= 0
  [[nodiscard]] const Sweep& at(int t) const {
    return sweeps_[std::size_t(std::min(t, makespan()))];
  }

 private:
  explicit MovingObstacle(std::vector<Sweep> sweeps) : sweeps_(std::move(sweeps)) {}

  std::vector<Sweep> sweeps_;
};

}  // namespace mvtp
