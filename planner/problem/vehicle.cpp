#include "planner/problem/vehicle.hpp"

#include <cmath>
#include <numbers>

namespace mvtp {

std::optional<VehiclePreset> vehicle_preset(std::string_view name) {
  if (name == "escot") {  // l = 3, w = 2, l_b = 2 m, phi_max = 40.1 deg, v_max = 1 m/s, dt = 1 s
    const double radius = 2.0 / std::tan(40.1 * std::numbers::pi / 180.0);
    return VehiclePreset{{.min_turning_radius = radius}, 1.0};
  }
  if (name == "cl-cbs") {  // r = 3 m, deltat = 0.706 rad per step
    return VehiclePreset{
        {.front = 2.0, .rear = 1.0, .wheelbase = 2.0, .min_turning_radius = 3.0}, 3.0 * 0.706};
  }
  return std::nullopt;
}

}  // namespace mvtp
