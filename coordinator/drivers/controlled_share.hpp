#pragma once

#include <cstdint>
#include <set>
#include <string>

namespace mvtp {

/// Which vehicles are automated (CAVs) and taken over at junctions; all others are human-driven and
/// keep the traffic's drivers.
struct ControlledShare {
  /// Share of the vehicles that are automated, 0 ... 1. A vehicle that is automated at one rate is
  /// so at every higher one.
  double penetration = 1.0;
  std::set<std::string> coordinate_types;  ///< only these may be automated; none named: all
  std::set<std::string> human_types;       ///< never automated
  std::uint64_t seed = 0;                  ///< another one draws other vehicles

  /// Is everybody automated?
  [[nodiscard]] bool is_whole() const {
    return penetration >= 1.0 && coordinate_types.empty() && human_types.empty();
  }
  [[nodiscard]] bool contains(const std::string& id, const std::string& type) const;
};

/// A number in [0, 1) that depends on nothing but the two, on every machine.
[[nodiscard]] double share_of_id(const std::string& id, std::uint64_t seed);

}  // namespace mvtp
