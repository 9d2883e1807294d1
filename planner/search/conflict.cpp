#include "planner/search/conflict.hpp"

#include <algorithm>

namespace mvtp {

Conflicts find_conflicts(std::span<const MovingObstacle* const> robots) {
  Conflicts result;
  int end = 0;
  for (const MovingObstacle* robot : robots) end = std::max(end, robot->makespan());
  for (int t = 0; t <= end; ++t) {
    for (int i = 0; i < int(robots.size()); ++i) {
      for (int j = i + 1; j < int(robots.size()); ++j) {
        if (!collide(robots[std::size_t(i)]->at(t), robots[std::size_t(j)]->at(t))) continue;
        ++result.count;
        if (!result.first) result.first = Conflict{i, j, t};
      }
    }
  }
  return result;
}

std::optional<int> first_conflict(const MovingObstacle& a, const MovingObstacle& b, int horizon) {
  for (int t = 0; t < horizon; ++t) {
    if (collide(a.at(t), b.at(t))) return t;
  }
  return std::nullopt;
}

}  // namespace mvtp
