#pragma once

#include <cstdint>
#include <optional>

#include "planner/algorithms/road_scene.hpp"

namespace mvtp {

/// Two vehicles of a plan that would touch.
struct PlannedContact {
  std::int64_t first = 0;  ///< keys
  std::int64_t second = 0;
  std::int64_t step = 0;  ///< of the simulation
};

/// Judges a plan before it is executed: do the true bodies of two vehicles touch at any step from
/// now to the end of the plan? Works on poses with the audit's geometry, not on contact tables, so
/// that planner and judge share no collision test.
///
/// @param every  looks at every so many steps, 1 or more.
[[nodiscard]] std::optional<PlannedContact> find_planned_contact(const RoadScene& scene,
                                                                 const JointPlan& plan, int every);

}  // namespace mvtp
