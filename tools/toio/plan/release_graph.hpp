#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "planner/geometry.hpp"
#include "planner/problem/vehicle.hpp"
#include "tools/toio/plan/reference.hpp"

namespace mvtp {

/// The places of the body in one segment of a motion, and a circle around all of them.
struct SegmentSweep {
  std::vector<OrientedBox> boxes;
  Point centre;
  double radius = 0.0;
};

/// Two robots whose bodies with margins are blocking each other at the same time of the plan, so
/// that no order of passing could keep them apart.
struct SweepConflict {
  std::size_t a = 0;
  std::size_t b = 0;
  std::size_t segment = 0;
};

using ReleaseGraph = std::vector<std::vector<Requirement>>;  ///< by robot, each by segment

/// The body in each segment, the last one at rest at the goal.
[[nodiscard]] std::vector<SegmentSweep> sweeps_of(const Reference& reference, const Vehicle& body);

/// Who has to wait for whom to leave, so that cubes which are late never meet.
///
/// Where the sweep of robot i's segment a meets that of j's segment b > a, j may not begin b before
/// i has left a. Every requirement points forward in the time of the plan, hence no circle of
/// robots waits for each other, however late any of them is: of those that are furthest behind,
/// each can end its segment. Requirements that follow from an earlier one are left out.
/// Sources: W. Hoenig et al., "Multi-agent path finding with kinematic constraints", ICAPS 2016
/// (temporal plan graph); "Persistent and robust execution of MAPF schedules in warehouses", RA-L
/// 4(2), 2019 (ADG).
[[nodiscard]] std::variant<ReleaseGraph, SweepConflict> build_release_graph(
    const std::vector<std::vector<SegmentSweep>>& sweeps);

/// The time up to which a robot may go: where its first segment begins whose requirements are not
/// met; its end if there is none.
/// @param reached by robot: the time on its own clock up to which its cube has come for sure.
[[nodiscard]] double released_until(std::span<const Requirement> requirements,
                                    const std::vector<Reference>& references, std::size_t robot,
                                    std::span<const double> reached);

}  // namespace mvtp
