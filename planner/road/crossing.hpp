#pragma once

#include <cstdint>
#include <vector>

#include "planner/road/profile_planner.hpp"

namespace mvtp {

struct CrossingOptions {
  ProfileOptions profile;
  int tries = 30;  ///< orders tried per call; 0: first come, first served
  /// More than so many vehicles are not planned anew in another order, but a few at a time, around
  /// all others.
  int many = 12;
  int per_try = 10;             ///< as many times per order that might be tried instead,
  int stagnation_limit = 60;    ///< and so often in a row without success
  int repairs = 30;             ///< times that a vehicle without a plan is moved to the front
  double headway_weight = 3.0;  ///< [s/s] cost of a headway that is missing at hand-back
};

struct CrossingResult {
  JointPlan plan;                       ///< complete speed profiles of all but `unplanned`
  std::vector<std::int64_t> unplanned;  ///< they brake; `plan` keeps clear of them
  double cost = 0.0;                    ///< [s] of `plan`
};

/// GetOptTraj [ESCoT, Alg. 2 l. 15] on roads: complete speed profiles for a group of vehicles,
/// planned one after another in an order of priority, which is searched.
///
/// @param keys  the group; newcomers (without an incumbent) come after the others, as given here.
/// @param incumbent  what the vehicles follow now; its order is where the search starts. The result
///     is never worse than the incumbent with the newcomers planned last.
/// If no order gives everybody a plan, whoever has none brakes, as a body that all others keep
/// clear of: old plans stand as long as they fit.
///
/// @param seed  of the moves tried. Same arguments, same result.
/// @param work  the search ends when it is used up; everybody's plan is looked for even then.
[[nodiscard]] CrossingResult plan_crossing(const RoadPairs& pairs,
                                           const std::vector<std::int64_t>& keys,
                                           const JointPlan& incumbent,
                                           const CrossingOptions& options, std::uint64_t seed,
                                           WorkBudget work = {});

}  // namespace mvtp
