#pragma once

#include "planner/problem/judged_plan.hpp"
#include "planner/problem/plan.hpp"
#include "planner/problem/referee_protocol.hpp"

namespace mvtp::referee {

/// The rules of space: kRobotOverlap, kObstacleOverlap and kBounds. Follows all vehicles from step
/// to step until the last one has arrived, but for places that overlap and may.
void judge_space(const JudgedPlan& plan, CollisionRule rule, Protocol& protocol);

}  // namespace mvtp::referee
