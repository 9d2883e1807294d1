#pragma once

#include <string>
#include <vector>

#include "planner/problem/instance.hpp"
#include "planner/problem/plan.hpp"
#include "planner/solve.hpp"

namespace mvtp {

/// What is wrong with the answer of solve(), one line each; empty if nothing is. The referee judges
/// the motion; the statistics are compared with the trajectories and with each other.
[[nodiscard]] std::vector<std::string> broken_properties(const Instance& instance,
                                                         const SolveOptions& options,
                                                         const Plan& plan);

}  // namespace mvtp
