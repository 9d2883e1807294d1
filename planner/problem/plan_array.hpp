#pragma once

#include <Eigen/Core>
#include <cassert>
#include <type_traits>
#include <utility>
#include <vector>

#include "planner/problem/plan.hpp"

namespace mvtp {

/// A trajectory as an array, one row per step t = 0, 1, ..., makespan(); the columns are those of
/// Waypoint: x, y [m] and heading [rad] of the rear axle in the world frame, and v [m/s] and phi
/// [rad], held constant during the step that ends in this row.
using StateArray = Eigen::Array<double, Eigen::Dynamic, 5, Eigen::RowMajor>;

/// A view of the trajectory's own states: valid as long as it lives and is not changed.
[[nodiscard]] inline Eigen::Map<const StateArray> states(const Trajectory& trajectory) {
  static_assert(std::is_standard_layout_v<Waypoint> && sizeof(Waypoint) == 5 * sizeof(double));
  const std::vector<Waypoint>& waypoints = trajectory.waypoints();
  return {&waypoints.front().pose.x, Eigen::Index(waypoints.size()), 5};
}
Eigen::Map<const StateArray> states(Trajectory&&) = delete;

/// The trajectory with these states. @pre there is at least one row
[[nodiscard]] inline Trajectory trajectory_of(const Eigen::Ref<const StateArray>& states) {
  assert(states.rows() > 0);
  std::vector<Waypoint> waypoints;
  for (const auto& row : states.rowwise()) {
    waypoints.push_back({{row[0], row[1], row[2]}, row[3], row[4]});
  }
  return Trajectory(std::move(waypoints));
}

}  // namespace mvtp
