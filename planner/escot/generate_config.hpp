#pragma once

#include <algorithm>
#include <concepts>
#include <optional>
#include <ranges>
#include <span>
#include <vector>

#include "planner/escot/pbcr.hpp"

namespace mvtp {

using Group = std::vector<int>;  ///< robots, ascending

/// What ESCoT asks of the world beside PBCR's StepWorld: how to find and plan groups.
template <class W>
concept GroupWorld = StepWorld<W> &&
    requires(W& world, const std::vector<typename W::State>& q, const Group& group) {
  /// Disjoint groups of robots that may conflict soon; robots on their own may be left out.
  { world.group_robots(q) } -> std::same_as<std::vector<Group>>;
  /// Is planning the group together worth trying?
  { world.pre_check(group) } -> std::same_as<bool>;
  /// The first motions of collision-free trajectories of the group to its goals, in its order;
  /// nullopt for a robot for which none was found.
  { world.get_opt_traj(q, group) } -> std::same_as<std::vector<std::optional<typename W::Motion>>>;
  /// Every robot once, highest priority first.
  { world.order(q) } -> std::same_as<std::vector<int>>;
};

/// One step of all robots: groups that can be planned together follow their joint trajectories, the
/// others are decided by PBCR, around them.
///
/// A group may be planned in part. Motions of groups must not conflict with those of groups before
/// them; a group whose motions do is left to PBCR like one that fails. If the others cannot make
/// room for the groups, PBCR decides for everybody.
/// Source: ESCoT paper, Algorithm 2, function GenerateConfig (lines 9-22).
template <GroupWorld World>
[[nodiscard]] std::vector<typename World::Motion> generate_config(
    World& world, const std::vector<typename World::State>& q) {
  using Motion = typename World::Motion;
  std::vector<std::optional<Motion>> decided(q.size());  // OCCU of lines 10-17

  const auto conflicts_with = [&](int i, const Motion& motion, int j) {
    const std::optional<Motion>& other = decided[std::size_t(j)];
    return other && world.conflict(i, motion, j, *other);
  };
  const auto conflicts_with_decided = [&](int i, const Motion& motion) {
    const auto conflicts = [&](int j) { return conflicts_with(i, motion, j); };
    if constexpr (LocalWorld<World>) return std::ranges::any_of(world.near(i), conflicts);
    return std::ranges::any_of(std::views::iota(0, int(q.size())), conflicts);
  };

  for (const Group& group : world.group_robots(q)) {    // lines 12-13
    if (!world.pre_check(group)) continue;              // line 14
    const auto motions = world.get_opt_traj(q, group);  // line 16
    bool fits = true;
    for (std::size_t k = 0; fits && k < group.size(); ++k) {
      fits = !motions[k] || !conflicts_with_decided(group[k], *motions[k]);
    }
    for (std::size_t k = 0; fits && k < group.size(); ++k) {
      decided[std::size_t(group[k])] = motions[k];  // line 17
    }
  }

  const Pbcr<World> pbcr(world);
  const std::vector<int> order = world.order(q);  // line 18
  if (auto motions = pbcr.step(q, order, std::move(decided))) return *std::move(motions);
  return pbcr.step(q, order).value();  // lines 19-21
}

}  // namespace mvtp
