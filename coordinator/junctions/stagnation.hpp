#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "planner/road.hpp"

namespace mvtp {

/// Finds groups that repeat their configuration, decision after decision.
///
/// Source: ESCoT paper, Algorithm 2, lines 4-6. On a road nobody drives back, so that a
/// configuration repeats only while everybody stands.
class Stagnation {
 public:
  /// Of the groups of two and more that are still there, those in which nobody has moved since the
  /// last call and nobody drives. To be called once in a decision.
  /// @param groups  keys of the vehicles that were planned together
  /// @param now  states by key; a vehicle of a group that is not there is left out
  /// @param seed  of the orders that are drawn
  /// @return keys, the vehicles of one group one after the other in an order that is drawn anew
  [[nodiscard]] std::vector<std::int64_t> duplicates(
      std::span<const std::vector<std::int64_t>> groups, std::map<std::int64_t, InertialState> now,
      std::uint64_t seed);

 private:
  std::map<std::int64_t, InertialState> last_;  ///< at the last call, by key
};

}  // namespace mvtp
