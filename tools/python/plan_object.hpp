#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "planner/problem/plan.hpp"

namespace mvtp {

/// A plan as Python has it: it also keeps the states of all robots as one block, which arrays of
/// the shape (n_robots, n_steps, ...) are views of.
class PlanObject {
 public:
  explicit PlanObject(Plan plan) : plan_(std::move(plan)) {}

  [[nodiscard]] const Plan& plan() const { return plan_; }

  /// The longest trajectory's waypoints.
  [[nodiscard]] std::size_t steps() const {
    std::size_t steps = 0;
    for (const Trajectory& t : plan_.trajectories) steps = std::max(steps, t.makespan() + 1);
    return steps;
  }

  /// steps() waypoints for each robot, one robot after the other; laid out once.
  [[nodiscard]] const std::vector<Waypoint>& states() const {
    if (!states_.empty()) return states_;
    for (const Trajectory& trajectory : plan_.trajectories) {
      for (std::size_t t = 0; t < steps(); ++t) {
        Waypoint waypoint = trajectory.at(t);
        if (t > trajectory.makespan()) waypoint.v = waypoint.phi = 0.0;  // it rests
        states_.push_back(waypoint);
      }
    }
    return states_;
  }

 private:
  Plan plan_;
  mutable std::vector<Waypoint> states_;
};

}  // namespace mvtp
