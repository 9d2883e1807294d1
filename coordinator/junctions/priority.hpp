#pragma once

#include <set>
#include <string>

#include "coordinator/traffic.hpp"

namespace mvtp {

/// Whose time counts for more at junctions.
struct Priority {
  static constexpr double kEmergency = 20.0;  ///< as many seconds of a car
  static constexpr double kBus = 4.0;

  std::set<std::string> types;  ///< ids of types that count like emergency vehicles

  /// Emergency vehicles (SUMO's class, or named), buses, or neither.
  enum class Kind { kNone, kBus, kEmergency };
  [[nodiscard]] Kind kind_of(const VehicleType& type) const {
    if (type.vehicle_class == "emergency" || types.contains(type.id)) return Kind::kEmergency;
    return type.vehicle_class == "bus" || type.vehicle_class == "coach" ? Kind::kBus : Kind::kNone;
  }
  /// How much a second of such a vehicle costs; 1: as much as that of any other.
  [[nodiscard]] double weight_of(const VehicleType& type) const {
    const Kind kind = kind_of(type);
    return kind == Kind::kEmergency ? kEmergency : kind == Kind::kBus ? kBus : 1.0;
  }
};

}  // namespace mvtp
