#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "planner/algorithms/joint_motion.hpp"
#include "planner/motion/timed_track.hpp"
#include "planner/problem/deadline.hpp"
#include "planner/search/soft_astar.hpp"

namespace mvtp {

struct StepsOptions {
  std::uint64_t seed = 0;
  int max_steps = 2000;         ///< buckets of time
  int patience = 40;            ///< steps without a new arrival before giving up
  int max_withdrawn = 200;      ///< see PbcrOptions
  int look_ahead = 5;           ///< steps of others that are no place to stand
  float look_ahead_gap = 0.3F;  ///< nor is what is so close to them [m]
  double in_the_way = 5.0;      ///< what each such step is worth [m]
  double guide_bonus = 1.5;     ///< what following the guide is worth [m]
};

/// What came of it: motions free of conflicts up to a common end, at which some robots may not be
/// at their goals yet.
struct StepsResult {
  std::vector<std::vector<Arc>> steps;  ///< per robot, one arc per instant, all of equal length
  std::vector<char> at_goal;
};

/// Moves all robots one bucket of time after the other with PBCR, each along its guide or on one of
/// the seven actions: quick, never in conflict, and far from the shortest plan.
///
/// `alone` are the robots' ways if they were alone, their first guides. Gives up when nobody has
/// arrived for long, and cuts back to the step with the most robots at home. Source: ESCoT paper,
/// Algorithm 1; Okumura et al. 2022 (PIBT).
[[nodiscard]] StepsResult plan_by_steps(std::span<const MacroRobot> robots,
                                        std::span<const TimedTrack> alone, SoftAstar& search,
                                        const StepsOptions& options, const Deadline& deadline);

}  // namespace mvtp
