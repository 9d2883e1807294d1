#pragma once

#include <optional>
#include <span>

#include "planner/search/moving_obstacle.hpp"

namespace mvtp {

/// Robots i < j overlap during step t.
struct Conflict {
  int i = 0;
  int j = 0;
  int t = 0;
};

/// The number of (pair, step) collisions, and the first of them: earliest step, lowest numbers.
struct Conflicts {
  int count = 0;
  std::optional<Conflict> first;
};

[[nodiscard]] Conflicts find_conflicts(std::span<const MovingObstacle* const> robots);

/// The first step in [0, horizon) at which the two overlap; nullopt if none.
[[nodiscard]] std::optional<int> first_conflict(const MovingObstacle& a, const MovingObstacle& b,
                                                int horizon);

}  // namespace mvtp
