#pragma once

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "planner/problem/validate.hpp"

/// Scenes for the referee.
namespace mvtp::validate_scene {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A box 3 x 2 m that turns on a circle of 2 m; the wheelbase of 1 m makes tan(phi) the curvature.
inline const Vehicle kCar{.front = 2.5,
                          .rear = 0.5,
                          .width = 2.0,
                          .wheelbase = 1.0,
                          .min_turning_radius = 2.0,
                          .max_speed = 1.0};

inline double phi_of(double curvature) { return std::atan(curvature * kCar.wheelbase); }

/// One step on: speed [m/s] and curvature [1/m] held for `dt`.
inline void move(Trajectory& trajectory, double v, double curvature, double dt = 1.0) {
  const Pose from = trajectory.waypoints().back().pose;
  trajectory.push_back({drive(from, v * dt, curvature), v, phi_of(curvature)});
}

struct Scene {
  Instance instance;
  Plan plan;

  explicit Scene(double width = 50.0, double height = 50.0) {
    instance.map.width = width;
    instance.map.height = height;
  }

  /// Adds a car that drives the (v, curvature) of each step, with the goal where it ends.
  Scene& add(const std::string& name, const Pose& start,
             const std::vector<std::pair<double, double>>& steps) {
    Trajectory trajectory(start);
    for (const auto& [v, curvature] : steps) move(trajectory, v, curvature, plan.statistics.dt);
    instance.agents.push_back({name, kCar, start, trajectory.waypoints().back().pose});
    plan.names.push_back(name);
    plan.trajectories.push_back(std::move(trajectory));
    return *this;
  }

  [[nodiscard]] std::vector<Violation> judge(
      CollisionRule rule = CollisionRule::kContinuous) const {
    return find_violations(instance, plan, rule);
  }

  [[nodiscard]] std::vector<Rule> broken(CollisionRule rule = CollisionRule::kContinuous) const {
    std::vector<Rule> rules;
    for (const Violation& violation : judge(rule)) rules.push_back(violation.rule);
    return rules;
  }
};

/// The same trajectory with its k-th waypoint changed.
template <class Change>
Trajectory changed(const Trajectory& trajectory, std::size_t k, const Change& change) {
  std::vector<Waypoint> waypoints = trajectory.waypoints();
  change(waypoints.at(k));
  return Trajectory(waypoints);
}

//   [0>  . . . . .        two cars, far apart, left and right turns, reverse and waits
//          <1]
inline Scene good_scene() {
  Scene scene;
  scene.add("a", {5, 5, 0}, {{1, 0}, {1, 0.5}, {1, -0.5}, {0, 0}, {-1, 0.5}, {0.3, 0.25}});
  scene.add("b", {30, 30, kPi}, {{1, 0.5}, {1, 0.5}, {1, 0.5}});
  return scene;
}

}  // namespace mvtp::validate_scene
