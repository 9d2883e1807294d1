#pragma once

#include <string>

#include "planner/problem/document.hpp"
#include "planner/problem/vehicle.hpp"

namespace mvtp {

/// The preset of this name. @param where  stands for the name's place in the message
/// @throws InputError if there is none
[[nodiscard]] VehiclePreset read_preset(const std::string& where, const std::string& name);

/// The `vehicle` of an instance, an agent or a plan: `{preset: escot, width: 1.8}`, in which fields
/// replace those of its preset, or else of `fallback`.
/// @throws InputError at the first field that is unknown or out of range
[[nodiscard]] VehiclePreset read_vehicle(const Value& value, const VehiclePreset& fallback);

/// The vehicle with every field; infinite limits are the default and have no text in YAML that all
/// readers share. read_vehicle() gives back the same vehicle, bit by bit.
[[nodiscard]] std::string vehicle_fields_text(const Vehicle& vehicle);
/// The same, by its preset where one fits.
[[nodiscard]] std::string vehicle_text(const Vehicle& vehicle);

/// The duration of a step that goes with the vehicle: its preset's, else that of "escot" [s].
[[nodiscard]] double usual_dt(const Vehicle& vehicle);

/// Beyond this, double loses the referee's millimetre [m].
inline constexpr double kMaxCoordinate = 1e6;
/// A number of at most kMaxCoordinate [m]. @throws InputError
[[nodiscard]] double read_coordinate(const Value& value);
/// The same, > 0.
[[nodiscard]] double read_length(const Value& value);

/// Steps and vehicles finer than this take more memory than there is [m], [s], [m/s], [m/s^2].
inline constexpr double kLeastOfVehicle = 1e-3;
/// A duration of a step within the limits of --dt [s]. @throws InputError
[[nodiscard]] double read_dt(const Value& value);
inline constexpr double kLongestStep = 1e6;  ///< [s]

}  // namespace mvtp
