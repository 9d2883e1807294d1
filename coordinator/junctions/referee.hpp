#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "planner/road.hpp"

namespace mvtp {

/// Two vehicles of a plan that would touch.
struct PlannedContact {
  std::int64_t first = 0;  ///< keys, the smaller one first
  std::int64_t second = 0;
  std::int64_t step = 0;  ///< of the simulation, at whose end or before which they touch
};

/// Judges a plan before it is executed: do the true bodies of two vehicles touch at any moment from
/// now to the end of the plan? Works on poses and by clearance(), not on contact tables, so that
/// planner and judge share no collision test.
///
/// Between two steps a body moves with a constant twist, as the audit sees it. Of each pair the
/// first contact is returned, ordered by keys; two that overlap now count once they were apart.
///
/// @param judged  a plan without contacts; pairs that still follow it are not looked at again.
[[nodiscard]] std::vector<PlannedContact> find_planned_contacts(const RoadScene& scene,
                                                                const JointPlan& plan,
                                                                const JointPlan& judged = {});

/// Would a driver who passes and yields to nobody touch, at any step from `step` on, a vehicle that
/// follows `plan` on a path of the library? The driver may be anywhere between its earliest and its
/// latest; of the true bodies, without margins.
[[nodiscard]] bool touches_passage(const PathLibrary& library, int path, const SpeedProfile& plan,
                                   const Forecast& passage, std::int64_t step);

/// Which of the groups have vehicles that would touch: their numbers, ascending.
[[nodiscard]] std::vector<std::size_t> groups_in_contact(
    std::span<const std::vector<std::int64_t>> groups, std::span<const PlannedContact> contacts);

/// Of the groups with contacts, those that do better with the plans they had before: the first
/// contact comes later, or as soon and with fewer pairs. Where a vehicle broke down old plans lead
/// into it.
/// @param contacts, before  of the new plan and of the old one, both of all pairs
/// @return their numbers, ascending
[[nodiscard]] std::vector<std::size_t> better_as_before(
    std::span<const std::vector<std::int64_t>> groups, std::span<const PlannedContact> contacts,
    std::span<const PlannedContact> before);

}  // namespace mvtp
