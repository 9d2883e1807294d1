#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "planner/anytime/repair.hpp"
#include "planner/problem/deadline.hpp"
#include "planner/search/joint_motion.hpp"

namespace mvtp {

/// Plans robots in turn, each without touching anybody: who had a turn drives, all others still
/// stand at their starts.
///
/// Slow but sure plans for places where hardly two can pass. As far as possible, robots go after
/// those whose start lies on their path, and before those whose goal does. Each needs a path among
/// the others at rest; it drives it as early as it can, or another path earlier still.
/// Source: revised prioritized planning, Cap et al. 2015, Algorithm 2; the order is ours.
class RevisedPrioritizedPlanning {
 public:
  /// @param motion, alone, deadline  outlive this object
  /// @param alone  the robots' paths if they were alone
  RevisedPrioritizedPlanning(JointMotion& motion, const std::vector<ArcTrajectory>& alone,
                             const Deadline& deadline);

  /// Replaces all motions by those found in turn, without a horizon. Who found no path, or had no
  /// turn before the time ran out or so many expansions let nobody go, stands at its start.
  void run(std::int64_t stagnation_limit);
  [[nodiscard]] bool has_departed(int i) const { return robots_[std::size_t(i)].departed; }
  /// How many have.
  [[nodiscard]] int departed() const {
    return int(std::ranges::count(robots_, true, &Robot::departed));
  }

 private:
  struct Robot {
    std::vector<int> starts_on_path_of;  ///< with its start
    std::vector<int> goals_on_path;      ///< their goals
    int starts_on_path = 0;              ///< of robots that have not departed
    int would_block = 0;                 ///< robots that have not departed, with its goal
    int failures = 0;                    ///< since anybody on its path has departed
    bool departed = false;
  };

  void find_who_blocks_whom();
  [[nodiscard]] int next() const;
  [[nodiscard]] bool let_go(int i);
  void leaves(int i);

  JointMotion& motion_;
  const std::vector<ArcTrajectory>& alone_;
  const Deadline& deadline_;
  Repair repair_;
  std::vector<Robot> robots_;
};

}  // namespace mvtp
