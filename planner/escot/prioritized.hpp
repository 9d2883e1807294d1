#pragma once

#include <cstdint>

#include "planner/escot/planner_result.hpp"
#include "planner/escot/planning_problem.hpp"
#include "planner/problem/deadline.hpp"

namespace mvtp {

struct PrioritizedOptions {
  double w = 1.2;              ///< of each robot's search, >= 1
  int max_expansions = 20000;  ///< of each robot's search
  int max_orders = 10000;      ///< that are tried
  /// An earlier robot leaves the starts of later ones alone for so many steps, so that they can
  /// get out of its path. >= 0
  int start_steps = 2;
  std::uint64_t seed = 0;  ///< of the orders
};

/// SHA*: prioritized planning. One robot after the other gets the quickest path that keeps clear of
/// those before it, which are moving obstacles, and stay where they arrive for ever: a path neither
/// crosses a robot that has parked, nor ends where one has yet to pass.
///
/// The order is longest path first. A robot without a path is put in front of all others; if that
/// order was tried before, the next one is random.
/// Source: Wen et al. 2022 (the baseline SHA*); Erdmann & Lozano-Perez 1987; the treatment of
/// starts and orders is that of Andreychuk & Yakovlev 2018.
[[nodiscard]] PlannerResult plan_prioritized(const PlanningProblem& problem,
                                             const PrioritizedOptions& options,
                                             const Deadline& deadline);

}  // namespace mvtp
