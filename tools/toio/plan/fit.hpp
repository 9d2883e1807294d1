#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/problem/plan.hpp"
#include "planner/problem/vehicle.hpp"
#include "tools/toio/plan/path.hpp"

namespace mvtp {

/// A plan to be driven by cubes: who drives, how, and in which bodies it was planned.
struct PlannedRobot {
  std::string name;
  Vehicle vehicle;
  Pose start;             ///< in the frame of the plan
  std::vector<Leg> legs;  ///< in the frame of the plan
};

/// What the user may choose.
struct FitOptions {
  Cube cube;
  TrackingMargins margins;
  double speed = 0.05;          ///< of the cube where the plan is fastest [m/s]
  double accel = 0.2;           ///< [m/s^2]
  std::optional<double> scale;  ///< metres on the desk per metre of the plan
};

/// How a plan lies on a mat.
struct Fit {
  Mat mat;
  Facing facing = Facing::kNoseFirst;
  PlanFrame frame;
  double speedup = 1.0;      ///< seconds of the plan per second
  double least_scale = 0.0;  ///< below it the cube with its margins sticks out of the planned body
  double most_scale = 0.0;   ///< above it the bodies with their margins leave the mat; 0: always
  double needs_width = 0.0;  ///< of the mat at the least scale, with the better turn [m]
  double needs_height = 0.0;
  double least_speed = 0.0;  ///< below it an inner wheel stands [m/s]
  std::string problem;       ///< why it does not fit; empty if it does
  std::string smallest_mat;  ///< that fits, if this one does not; empty: none
};

/// Lays a plan on a mat.
///
/// The scale is the largest that fits, but at most half as large again as the least: larger ones
/// only take longer. Of the two facings the one with the lower least scale is taken.
/// @pre robots is not empty
[[nodiscard]] Fit fit_to_mat(const std::vector<PlannedRobot>& robots, double dt, const Mat& mat,
                             const FitOptions& options);

}  // namespace mvtp
