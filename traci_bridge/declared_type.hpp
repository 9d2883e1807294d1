#pragma once

#include <string>

namespace mvtp {

/// SUMO gives a vehicle whose parameters were changed a type of its own, TYPE@VEHICLE.
/// @return the TYPE that was declared
[[nodiscard]] inline std::string declared_type(std::string type, const std::string& vehicle) {
  if (type.ends_with('@' + vehicle)) type.resize(type.size() - vehicle.size() - 1);
  return type;
}

}  // namespace mvtp
