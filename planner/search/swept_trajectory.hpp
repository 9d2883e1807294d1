#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "planner/motion/stepped_car.hpp"

namespace mvtp {

/// The sweeps of a robot's steps, and then its footprint at rest for ever. Copies and parts share
/// them, so that they cost nothing.
class SweptTrajectory {
 public:
  SweptTrajectory(const SteppedCar& car, Pose start, const std::vector<Arc>& steps) {
    std::vector<Sweep> sweeps;
    sweeps.reserve(steps.size() + 1);
    for (const Arc& arc : steps) {
      sweeps.push_back(car.sweep(start, arc));
      start = drive(start, arc);
    }
    sweeps.push_back(car.sweep(start, {}));
    makespan_ = int(steps.size());
    sweeps_ = std::make_shared<const std::vector<Sweep>>(std::move(sweeps));
    first_ = sweeps_->data();
  }

  /// Its steps from t on, at most so many; then at rest. @pre t >= 0, steps > 0
  [[nodiscard]] SweptTrajectory part(int t, int steps) const {
    const int first = std::min(t, makespan_);
    SweptTrajectory result = *this;
    result.first_ += first;
    result.makespan_ = std::min(makespan_ - first, steps);
    return result;
  }

  /// The number of steps until it rests.
  [[nodiscard]] int makespan() const { return makespan_; }
  /// The sweep of step t, from time t to t + 1. @pre t >= 0
  [[nodiscard]] const Sweep& at(int t) const { return first_[std::min(t, makespan_)]; }

 private:
  std::shared_ptr<const std::vector<Sweep>> sweeps_;
  const Sweep* first_ = nullptr;  ///< of makespan_ + 1 in sweeps_
  int makespan_ = 0;
};

}  // namespace mvtp
