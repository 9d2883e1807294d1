#pragma once

#include <compare>
#include <span>
#include <vector>

#include "planner/search/swept_trajectory.hpp"

namespace mvtp {

/// Robots i < j overlap during step t. Ordered by time, then by number.
struct Conflict {
  int t = 0;
  int i = 0;
  int j = 0;

  friend auto operator<=>(const Conflict&, const Conflict&) = default;
};

/// Every (pair, step) collision, in order.
[[nodiscard]] std::vector<Conflict> find_conflicts(std::span<const SweptTrajectory> robots);

/// Every collision of `own`, as the motion of robot i, with the other robots, in order.
[[nodiscard]] std::vector<Conflict> find_conflicts_of(int i, const SweptTrajectory& own,
                                                      std::span<const SweptTrajectory> robots);

}  // namespace mvtp
