#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <unordered_map>
#include <vector>

#include "planner/algorithms/conflict_based_search.hpp"
#include "planner/algorithms/fleet.hpp"
#include "planner/algorithms/generate_config.hpp"
#include "planner/problem/deadline.hpp"

namespace mvtp {

struct SteppedWorldOptions {
  bool grouping = true;  ///< false: PBCR alone
  int window = 10;       ///< robots that will conflict within so many steps are grouped, >= 1
  int max_group = 5;     ///< robots in a group, at most
  /// PreCheck: a group that could not be planned is not tried again for so many steps.
  int retry_after = 5;
  CbsOptions eccr{
      .w = 1.5, .cost = CbsCost::kLateForSlowest, .max_nodes = 200, .max_expansions = 2000};
  double guide_w = 1.2;          ///< weight of the search for a guide path, >= 1
  int guide_expansions = 20000;  ///< of that search
};

/// SteppedCar robots as PBCR and ESCoT see them: what each remembers, wants, and is on its way to.
///
/// A robot follows its guide: steps to its goal, either its own (hybrid A*, others ignored) or its
/// part of a group's joint trajectory. It gets a new one when it is pushed off.
class SteppedWorld {
 public:
  using State = Pose;
  struct Motion {
    Arc arc;
    Pose end;
    Sweep sweep;  ///< the safe stop after the step is `end` itself
  };

  SteppedWorld(const Fleet& fleet, const SteppedWorldOptions& options, const Deadline& deadline);

  // StepWorld
  /// Six arcs, a wait and the greedy action, by score; random actions first [ESCoT Sec. III-E].
  [[nodiscard]] std::vector<Motion> candidates(int i, const Pose& pose) const;
  /// The same for a robot that is pushed: places where the pusher goes next are worse.
  [[nodiscard]] std::vector<Motion> evasions(int i, const Pose& pose, int pusher,
                                             const Motion& motion) const;
  [[nodiscard]] Motion safe_stop(int i, const Pose& pose) const { return motion(i, pose, {}); }
  [[nodiscard]] bool conflict(int, const Motion& a, int, const Motion& b) const {
    return collide(a.sweep, b.sweep);
  }

  // GroupWorld
  [[nodiscard]] std::vector<Group> group_robots(const Configuration& q);
  [[nodiscard]] bool pre_check(const Group& group) const;
  [[nodiscard]] std::optional<std::vector<Motion>> get_opt_traj(const Configuration& q,
                                                                const Group& group);
  [[nodiscard]] std::vector<int> order(const Configuration& q) const;

  /// Gives a guide to every robot that has none or is not on it. To be called before each step.
  void prepare(const Configuration& q);
  /// Takes note of what everybody did.
  void advance(const std::vector<Motion>& motions);
  /// Makes the next step different: random actions for some robots, and a random "last action" for
  /// some [ESCoT Sec. III-E].
  void add_randomness(const Configuration& q, std::mt19937_64& rng);

 private:
  struct Robot {
    std::optional<MovingObstacle> prediction;  ///< along the guide
    std::vector<Arc> guide;                    ///< steps to the goal
    std::size_t next = 0;                      ///< of the guide
    Pose expected;                             ///< where the guide goes on
    int search_again = 0;                      ///< > 0: no guide was found, wait until this step
    int joint = -1;                            ///< the joint trajectory that the guide is part of
    std::unordered_map<std::uint64_t, double> visits;  ///< how much each cell is to be avoided
    Arc last;                                          ///< last arc driven
    int steps_under_way = 0;                           ///< since it was last at its goal
    int retreat = 0;                                   ///< steps straight on, off its guide
    std::optional<Arc> random_action;                  ///< for the next step only
  };

  /// Who pushes a robot, from where, and where to next.
  struct Push {
    const std::vector<Sweep>* ahead = nullptr;  ///< nullptr: nobody
    int by = -1;
    Pose from;
  };

  [[nodiscard]] Motion motion(int i, const Pose& pose, const Arc& arc) const;
  [[nodiscard]] double score(int i, const Motion& motion, bool greedy) const;
  [[nodiscard]] std::uint64_t cell(int i, const Pose& pose) const;
  /// In how many steps the two will overlap if they follow their guides; nullopt: not soon.
  [[nodiscard]] std::optional<int> predicted_conflict(int i, int j) const;
  [[nodiscard]] std::vector<Motion> candidates_away_from(int i, const Pose& pose,
                                                         const Push& push) const;
  /// How far robot i, in `pose`, is from having left the lane of the robot that pushes it and is
  /// now at `pushed_by` [m]: the way aside, of which a turn across the lane is worth a radius.
  [[nodiscard]] double still_to_clear(int i, const Pose& pose, int pusher,
                                      const Pose& pushed_by) const;
  [[nodiscard]] std::optional<TimedPath> find_guide(int i, const Pose& pose) const;
  void break_joint(int joint);
  void set_guide(int i, const Pose& pose, std::vector<Arc> guide, int joint);

  const Fleet& fleet_;
  SteppedWorldOptions options_;
  const Deadline& deadline_;
  SpacetimeHybridAstar planner_;
  std::vector<Robot> robots_;
  std::map<Group, int> failed_;  ///< groups, and the step in which they could not be planned
  int step_ = 0;
  int joints_ = 0;  ///< so many joint trajectories were made
};

}  // namespace mvtp
