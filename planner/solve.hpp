#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "planner/problem/deadline.hpp"
#include "planner/problem/instance.hpp"
#include "planner/problem/pbcr_score.hpp"
#include "planner/problem/plan.hpp"

namespace mvtp {

struct SolveOptions {
  std::string algorithm = "escot";  ///< one of algorithm_names()
  CollisionRule collision = CollisionRule::kContinuous;
  std::uint64_t seed = 0;
  int runs = 1;                 ///< tried one after the other with seeds seed, seed + 1, ...; >= 1
  double run_time_limit = 1e9;  ///< of each run [s], > 0
  double gap = 0.01;            ///< escot-star stops at a makespan of (1 + gap) * lower bound, >= 0
  int threads = 1;              ///< of escot-star, >= 1; the others use one
  PbcrScore pbcr = PbcrScore::kStrengthened;  ///< of escot and pbcr
};

/// The algorithms that solve() knows, the default first.
[[nodiscard]] const std::vector<std::string>& algorithm_names();

/// Plans for all robots.
///
/// `statistics` of the result is filled but for `version`; `seed` is that of the last run. Its
/// trajectories end exactly at the goals if the status is "solved"; else they are as far as the
/// search came, or empty. Same instance and options give the same plan but for
/// `statistics.runtime`, unless the deadline ends the search.
/// @throws InputError for an unknown algorithm.
[[nodiscard]] Plan solve(const Instance& instance, const SolveOptions& options,
                         const Deadline& deadline);

}  // namespace mvtp
