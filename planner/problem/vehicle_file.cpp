#include "planner/problem/vehicle_file.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "planner/problem/input_error.hpp"
#include "planner/problem/yaml_text.hpp"

namespace mvtp {
namespace {

/// A field of a vehicle as files name it.
struct Field {
  std::string_view key;
  double Vehicle::*value;
  std::string_view unit;
};
constexpr std::array<Field, 8> kFields = {{
    {"front", &Vehicle::front, "m"},
    {"rear", &Vehicle::rear, "m"},
    {"width", &Vehicle::width, "m"},
    {"wheelbase", &Vehicle::wheelbase, "m"},
    {"min_turning_radius", &Vehicle::min_turning_radius, "m"},
    {"max_speed", &Vehicle::max_speed, "m/s"},
    {"max_accel", &Vehicle::max_accel, "m/s^2"},
    {"max_decel", &Vehicle::max_decel, "m/s^2"},
}};

double read_between(const Value& value, double least, double most, std::string_view unit) {
  const double x = value.positive(unit);
  if (x >= least && x <= most) return x;
  throw InputError(value.where(),
                   fmt::format("is {} {}; give {} to {} {}", x, unit, least, most, unit));
}

/// The preset whose vehicle this is.
std::optional<std::string_view> preset_of(const Vehicle& vehicle) {
  for (const std::string_view name : {"escot", "cl-cbs"}) {
    if (vehicle_preset(name).value().vehicle == vehicle) return name;
  }
  return std::nullopt;
}

}  // namespace

double read_coordinate(const Value& value) {
  const double x = value.number("m");
  if (std::abs(x) > kMaxCoordinate) {
    throw InputError(value.where(), fmt::format("is {} m; give at most {} m", x, kMaxCoordinate));
  }
  return x;
}

double read_dt(const Value& value) {
  return read_between(value, kLeastOfVehicle, kLongestStep, "s");
}

double read_length(const Value& value) {
  (void)value.positive("m");
  return read_coordinate(value);
}

VehiclePreset read_preset(const std::string& where, const std::string& name) {
  const std::optional<VehiclePreset> found = vehicle_preset(name);
  if (!found) {
    throw InputError(where,
                     fmt::format("is the unknown preset \"{}\"; choose escot or cl-cbs", name));
  }
  return *found;
}

VehiclePreset read_vehicle(const Value& value, const VehiclePreset& fallback) {
  value.require_map("{preset: escot}");
  value.require_known_keys({"preset", "front", "rear", "width", "wheelbase", "min_turning_radius",
                            "max_speed", "max_accel", "max_decel"});
  VehiclePreset result = fallback;
  if (const auto name = value.find("preset")) result = read_preset(name->where(), name->text());
  for (const auto& [key, field, unit] : kFields) {
    const std::optional<Value> entry = value.find(key);
    if (!entry) continue;
    const bool is_overhang = key == "front" || key == "rear";  // may be negative, not both
    result.vehicle.*field = is_overhang
                                ? read_coordinate(*entry)
                                : read_between(*entry, kLeastOfVehicle, kMaxCoordinate, unit);
  }
  if (!(result.vehicle.length() > 0.0)) {
    throw InputError(value.where(),
                     fmt::format("front {} m + rear {} m is no positive length; both are counted "
                                 "outwards from the rear axle",
                                 result.vehicle.front, result.vehicle.rear));
  }
  return result;
}

std::string vehicle_fields_text(const Vehicle& vehicle) {
  std::string text;
  for (const auto& [key, field, unit] : kFields) {
    if (!std::isfinite(vehicle.*field)) continue;
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", key, yaml_number(vehicle.*field));
  }
  return "{" + text + "}";
}

std::string vehicle_text(const Vehicle& vehicle) {
  const std::optional<std::string_view> preset = preset_of(vehicle);
  return preset ? fmt::format("{{preset: {}}}", *preset) : vehicle_fields_text(vehicle);
}

double usual_dt(const Vehicle& vehicle) {
  return vehicle_preset(preset_of(vehicle).value_or("escot")).value().dt;
}

}  // namespace mvtp
