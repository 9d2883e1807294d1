#pragma once

#include <atomic>

#include "planner/solve.hpp"

namespace mvtp {

/// Plans, and lets the referee judge: a plan that breaks a rule is no solution ("invalid"),
/// whatever the solver says. `statistics` is filled, `version` too.
/// @param stop  ends the search as soon as it is true
/// @throws InputError for an unknown algorithm
[[nodiscard]] Plan solve_and_judge(const Instance& instance, const SolveOptions& options,
                                   const Deadline& deadline, const std::atomic<bool>& stop);

}  // namespace mvtp
