#pragma once

#include "planner/algorithms/fleet.hpp"

namespace mvtp {

/// Was a motion found that takes robot i from its start to its goal among the obstacles, the other
/// robots absent?
///
/// True is a proof; false says that hybrid A* found none within its budget, with steps of any of
/// three lengths. The clock plays no part.
[[nodiscard]] bool solvable_alone(const Fleet& fleet, int i);

}  // namespace mvtp
