#pragma once

#include <vector>

#include "tools/toio/plan/export.hpp"

namespace mvtp {

inline void add_straight(std::vector<Leg>& legs, Pose from, int waits, int metres) {
  for (int i = 0; i < waits; ++i) legs.push_back({from, {0.0, 0.0}, {}});
  for (int i = 0; i < metres; ++i) {
    legs.push_back({from, {1.0, 0.0}, {}});
    from = drive(from, 1.0, 0.0);
  }
}

/// Two robots whose paths cross at (7, 7), 5 m after the start; the one that heads up waits for so
/// many seconds first.
///
///        ^ b's goal
///   a > -+- > a's goal
///        ^ b
inline std::vector<PlannedRobot> crossing(int wait = 4) {
  const Vehicle vehicle{.front = 1.5, .rear = 1.1, .width = 2.3};
  std::vector<PlannedRobot> robots = {{"a", vehicle, {2.0, 7.0, 0.0}, {}},
                                      {"b", vehicle, {7.0, 2.0, 1.5707963267948966}, {}}};
  add_straight(robots[0].legs, robots[0].start, 0, 10);
  add_straight(robots[1].legs, robots[1].start, wait, 10);
  return robots;
}

inline Exported exported(const std::vector<PlannedRobot>& robots,
                         const ExportOptions& options = {}) {
  const FitOptions fitting;
  const Fit fit = fit_to_mat(robots, 1.0, find_mat("collection-ring"), fitting);
  return make_run(robots, 1.0, fit, fitting, options);
}

/// The crossing with margins as wide as targets need them.
inline Exported exported_for_targets() {
  const FitOptions fitting{.margins = {0.0205, 0.0205}};
  const std::vector<PlannedRobot> robots = crossing(8);
  const Fit fit = fit_to_mat(robots, 1.0, find_mat("collection-ring"), fitting);
  return make_run(robots, 1.0, fit, fitting, {.mode = DriveMode::kTarget});
}

}  // namespace mvtp
