#include "planner/search/conflict.hpp"

#include <algorithm>

namespace mvtp {
namespace {

/// Appends the collisions of robots i and j, whose motions are `a` and `b`.
void append(std::vector<Conflict>& conflicts, int i, const SweptTrajectory& a, int j,
            const SweptTrajectory& b) {
  const int end = std::max(a.makespan(), b.makespan());
  for (int t = 0; t <= end; ++t) {
    if (collide(a.at(t), b.at(t))) conflicts.push_back({t, std::min(i, j), std::max(i, j)});
  }
}

}  // namespace

std::vector<Conflict> find_conflicts(std::span<const SweptTrajectory> robots) {
  std::vector<Conflict> conflicts;
  for (int i = 0; i < int(robots.size()); ++i) {
    for (int j = i + 1; j < int(robots.size()); ++j) {
      append(conflicts, i, robots[std::size_t(i)], j, robots[std::size_t(j)]);
    }
  }
  std::ranges::sort(conflicts);
  return conflicts;
}

std::vector<Conflict> find_conflicts_of(int i, const SweptTrajectory& own,
                                        std::span<const SweptTrajectory> robots) {
  std::vector<Conflict> conflicts;
  for (int j = 0; j < int(robots.size()); ++j) {
    if (j != i) append(conflicts, i, own, j, robots[std::size_t(j)]);
  }
  std::ranges::sort(conflicts);
  return conflicts;
}

}  // namespace mvtp
