#pragma once

/// @file
/// One robot of an instance, all others absent: can it get to its goal? For those who make
/// instances, and want none that a robot cannot solve even alone.
///
/// What a caller does: a PlanningProblem from the Instance, which must outlive it; then
/// solvable_alone() for robot 0 to PlanningProblem::size() - 1, in the order of the agents.
/// find_single_agent_path() gives the arcs themselves.
///
/// - Units and frame: those of the Instance. Metres and radians in the world's frame, poses of the
///   rear axle; an Arc is a step or less, from the start on.
/// - Errors: nothing throws, but for want of memory. "false" is no proof that there is no path: the
///   search ends after a number of expansions, the same on every machine.
/// - Threads: a PlanningProblem is for one thread; its tables fill as they are asked.
/// - Sources: hybrid A* with Reeds-Shepp curves, steps of the ESCoT paper, Sec. III-A.

// IWYU pragma: begin_exports
#include "planner/escot/single_agent_path.hpp"
// IWYU pragma: end_exports
