#pragma once

#include <limits>
#include <optional>
#include <string_view>

namespace mvtp {

/// What the planner knows of one car-like vehicle: a rectangle around its rear axle and its limits.
///
/// Units: metres, m/s, m/s^2, 1/m. Invariant of a valid vehicle: all lengths and limits are positive
/// but `rear`, which may be any number with front + rear > 0.
struct Vehicle {
  double front = 2.5;               ///< from the rear axle to the front bumper
  double rear = 0.5;                ///< from the rear axle to the rear bumper
  double width = 2.0;
  double wheelbase = 2.0;
  double min_turning_radius = 2.375;  ///< of the rear-axle centre
  double max_speed = 1.0;
  double max_accel = std::numeric_limits<double>::infinity();  ///< InertialCar only
  double max_decel = std::numeric_limits<double>::infinity();  ///< InertialCar only

  [[nodiscard]] double length() const { return front + rear; }
  [[nodiscard]] double max_curvature() const { return 1.0 / min_turning_radius; }

  friend bool operator==(const Vehicle&, const Vehicle&) = default;
};

/// A vehicle with the duration of one planner step that its source uses [s].
struct VehiclePreset {
  Vehicle vehicle;
  double dt = 1.0;
};

/// The presets `escot` (the paper's car) and `cl-cbs` (the peers' car); nullopt for other names.
[[nodiscard]] std::optional<VehiclePreset> vehicle_preset(std::string_view name);

}  // namespace mvtp
