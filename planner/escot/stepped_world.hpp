#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <unordered_map>
#include <vector>

#include "planner/escot/conflict_based_search.hpp"
#include "planner/escot/generate_config.hpp"
#include "planner/escot/neighbours.hpp"
#include "planner/escot/planning_problem.hpp"
#include "planner/problem/deadline.hpp"
#include "planner/problem/pbcr_score.hpp"

namespace mvtp {

struct SteppedWorldOptions {
  std::uint64_t seed = 0;  ///< of the noise that tells equally good steps apart
  PbcrScore score = PbcrScore::kStrengthened;
  bool grouping = true;  ///< false: PBCR alone
  int window = 10;       ///< robots that will conflict within so many steps are grouped, >= 1
  int max_group = 5;     ///< robots in a group, at most
  /// PreCheck: a group that could not be planned is not tried again for so many steps.
  int retry_after = 5;
  CbsOptions eccr{
      .w = 1.5, .cost = CbsCost::kLateForSlowest, .max_nodes = 50, .max_expansions = 300};
  double reference_path_w = 1.4;          ///< weight of the search for a reference path, >= 1
  int reference_path_expansions = 20000;  ///< of that search
};

/// SteppedCar robots as PBCR and ESCoT see them: what each remembers, wants, and is on its way to.
///
/// A robot follows its reference path: steps to its goal, either its own (hybrid A*, others
/// ignored) or its part of a group's joint trajectory. It gets a new one when it is pushed off.
class SteppedWorld {
 public:
  using State = Pose;
  struct Motion {
    Arc arc;
    Pose end;
    Sweep sweep;  ///< the safe stop after the step is `end` itself
  };

  class Ranking;

  SteppedWorld(const PlanningProblem& problem, const SteppedWorldOptions& options,
               const Deadline& deadline);

  // StepWorld
  /// Six arcs, a wait and the greedy action, by score; random motions first [ESCoT Sec. III-E].
  [[nodiscard]] Ranking candidates(int i, const Pose& pose) const;
  /// To stay at the goal or to follow the reference path, where nothing speaks against it.
  [[nodiscard]] std::optional<Motion> first_choice(int i, const Pose& pose) const;
  /// The same for a robot that is pushed: it also gives way to its pusher, after that one's motion.
  [[nodiscard]] Ranking push_candidates(int i, const Pose& pose, int pusher,
                                        const Motion& motion) const;
  [[nodiscard]] Motion safe_stop(int i, const Pose& pose) const { return motion(i, pose, {}); }
  [[nodiscard]] bool conflict(int i, const Motion& a, int j, const Motion& b) const {
    return collide(a.sweep, b.sweep) && !is_exempt(i, a, j, b);
  }

  /// Those that i can meet in one step, highest priority first.
  [[nodiscard]] std::span<const int> near(int i) const { return robots_[std::size_t(i)].near; }

  // GroupWorld
  /// Those that will conflict soon, most urgent conflicts first; nobody who is to act at random.
  [[nodiscard]] std::vector<Group> group_robots(const Configuration& q);
  /// Did the group not fail shortly before? Its size is kept by group_robots().
  [[nodiscard]] bool pre_check(const Group& group) const;
  /// For the whole group, or for nobody in it.
  [[nodiscard]] std::vector<std::optional<Motion>> get_opt_traj(const Configuration& q,
                                                                const Group& group);
  /// Longest under way first, then who had the longest path from its start.
  [[nodiscard]] std::vector<int> order(const Configuration&) const { return order_; }

  /// Gives a reference path to every robot that has none or is not on it, and looks who is near
  /// whom. To be called before each step.
  void update_reference_paths(const Configuration& q);
  /// Takes note of what everybody did.
  void advance(const std::vector<Motion>& motions);
  /// Makes the next step different: random motion primitives for some robots, and a random "last
  /// motion primitive" for some [ESCoT Sec. III-E].
  void add_randomness(const Configuration& q, std::mt19937_64& rng);

  /// Groups that pre_check() has in mind, for one who looks after the memory.
  [[nodiscard]] std::size_t failures_kept() const { return failed_.size(); }

 private:
  /// How much a robot has been in a cell, not counting its own path; forgotten bit by bit.
  struct CellCount {
    double value = 0.0;
    int step = 0;  ///< when it had that value
  };

  struct Robot {
    std::optional<SweptTrajectory> prediction;  ///< along the reference path
    std::vector<Arc> reference_path;            ///< steps to the goal
    std::size_t next = 0;                       ///< of the reference path
    Pose expected;                              ///< where the reference path goes on
    int search_again = 0;                       ///< > 0: no path was found, wait until this step
    int searched_in_vain = 0;                   ///< so many times since the last success
    int joint = -1;                             ///< the joint trajectory that the path is part of
    int changed = 0;        ///< the last step in which its path, being on time or joint changed
    bool disputed = false;  ///< had a predicted conflict when groups were made last
    std::unordered_map<std::uint64_t, CellCount> times_in_cell;  ///< by cell
    Arc last;                                                    ///< last arc driven
    double distance = 0.0;                                       ///< from its start to its goal [m]
    int steps_under_way = 0;                                     ///< since it was last at its goal
    int stuck = 0;                      ///< steps since it was at its goal or went along its path
    int rank = 0;                       ///< in the order of this step
    std::vector<int> near;              ///< see near()
    std::vector<int> within_lookahead;  ///< those whose next steps may lead over where it goes now
    std::optional<Arc> random_primitive;  ///< for the next step only
  };

  /// What another robot sweeps after this step: no place to stand for who has to give way to it.
  struct GroundAhead {
    int of = -1;
    Pose from;
    const SweptTrajectory* along = nullptr;
    int next = 0;   ///< the step of `along` that comes after this one
    int steps = 0;  ///< so many from there on are looked at
    Point middle;   ///< a circle around all of it
    double radius = 0.0;

    [[nodiscard]] bool may_meet(const GroundAhead& other) const;
  };

  /// May two that overlap at their starts, or at their goals, do so during these motions?
  [[nodiscard]] bool is_exempt(int i, const Motion& a, int j, const Motion& b) const;
  [[nodiscard]] Motion motion(int i, const Pose& pose, const Arc& arc) const;
  [[nodiscard]] Motion motion(int i, const Pose& pose, const Frame& frame,
                              const Primitive& step) const;
  /// The next step of the reference path. @pre has_reference_path(i)
  [[nodiscard]] Motion greedy_motion(int i, const Pose& pose) const;
  [[nodiscard]] bool has_reference_path(int i) const {
    return robots_[std::size_t(i)].next < robots_[std::size_t(i)].reference_path.size();
  }
  /// What driving the arc is worth [m], after the last arc of robot i.
  [[nodiscard]] double penalty(int i, const Arc& arc) const;
  /// What counts against a motion of robot i, whatever the others do [m].
  [[nodiscard]] double score(int i, const Motion& motion, bool greedy) const;
  /// What counts against driving straight without coming closer, pushed by a straight motion [m];
  /// PBCR's authors have it.
  [[nodiscard]] double head_on_cost(int i, const Pose& pose, const Motion& motion,
                                    const Motion& pusher) const;
  /// What is left to the goal after a motion, the strengthened estimate of it [m].
  [[nodiscard]] double to_go_after(int i, const Motion& motion, bool greedy) const;
  /// What counts against standing where others pass, or against meeting them farther along the
  /// reference path if the motion is the greedy one [m].
  [[nodiscard]] double blocking_cost(int i, const Motion& motion, bool greedy,
                                     std::span<const GroundAhead> grounds) const;
  [[nodiscard]] double times_in_cell(int i, const Pose& pose) const;
  [[nodiscard]] std::uint64_t cell(int i, const Pose& pose) const;
  /// How many steps of others are looked at.
  [[nodiscard]] int look_ahead(int i) const;
  /// Is robot i where it was expected to be when groups were made last, with the same plans?
  [[nodiscard]] bool as_foreseen(int i) const {
    return grouped_at_ == step_ - 1 && robots_[std::size_t(i)].changed < grouped_at_;
  }
  /// In how many steps the two will overlap on their reference paths; nullopt: not soon.
  [[nodiscard]] std::optional<int> predicted_conflict(int i, int j) const;
  [[nodiscard]] GroundAhead ground_ahead(int i, const Pose& from, const SweptTrajectory& along,
                                         int next) const;
  /// Where those go that robot i has to give way to.
  [[nodiscard]] std::vector<GroundAhead> grounds_to_keep_clear(int i) const;
  /// How far robot i, in `pose`, is from having left the lane of another one [m]: the path aside,
  /// of which a turn across the lane is worth a radius.
  [[nodiscard]] double still_to_clear(int i, const Pose& pose, const GroundAhead& ground) const;
  /// No point of the body is farther from the rear axle during one step, wherever that starts [m].
  [[nodiscard]] double reach(int i) const;
  [[nodiscard]] bool is_plain() const { return options_.score == PbcrScore::kPaper; }
  void set_order(const Configuration& q);
  /// Takes note that robot i was in the cell of `pose` once more.
  void count_cell(int i, const Pose& pose);
  void update_neighbours(const Configuration& q);
  /// A circle around all places where robot i can be while groups look at it.
  [[nodiscard]] Circle reachable_disc(int i) const;
  [[nodiscard]] std::optional<SearchResult> find_reference_path(int i, const Pose& pose) const;
  void break_joint(int joint);
  void set_reference_path(int i, const Pose& pose, std::vector<Arc> reference_path, int joint);

  const PlanningProblem& problem_;
  SteppedWorldOptions options_;
  const Deadline& deadline_;
  SpacetimeHybridAstar planner_;
  std::vector<Robot> robots_;
  double longest_reach_ = 0.0;  ///< the largest reach() [m]
  double longest_step_ = 0.0;   ///< [m]
  Configuration now_;           ///< where they are; kept only if some overlap from the start on
  std::vector<int> order_;      ///< robots, highest priority first
  Neighbours neighbours_;
  std::vector<Circle> reachable_discs_;  ///< of each robot, see reachable_disc()
  /// Groups, and the step in which they could not be planned; forgotten once they may be tried.
  std::map<Group, int> failed_;
  int step_ = 0;
  int grouped_at_ = -1;  ///< the last step in which groups were made
  int joints_ = 0;       ///< so many joint trajectories were made
};

/// The motions of one robot in one step, best first.
///
/// Who blocks whom takes most of the time and only adds to a score: it is asked for no motion
/// that would come later anyway.
class SteppedWorld::Ranking {
 public:
  /// @param grounds  to be kept clear
  /// @param along  what one of them points at, if nobody else keeps it
  Ranking(const SteppedWorld& world, int robot, const Pose& pose, std::vector<GroundAhead> grounds,
          std::shared_ptr<const SweptTrajectory> along = nullptr);

  /// Of a robot that is pushed, as PBCR's authors rank them.
  Ranking(const SteppedWorld& world, int robot, const Pose& pose, const Motion& pusher);

  /// Number k, from 0 on; nullptr if there are not so many. The pointers stay valid.
  friend const Motion* nth(Ranking& ranking, std::size_t k) { return ranking.nth_motion(k); }

 private:
  struct Entry {
    Motion motion;
    double score;         ///< at least
    bool greedy = false;  ///< the next step of the reference path
    bool known = false;   ///< the score is exact, and the motion hits no obstacle
  };

  const Motion* nth_motion(std::size_t k);
  /// Puts the best of what is left in place; false if nothing is.
  bool find_next();

  const SteppedWorld& world_;
  int robot_;
  Pose pose_;
  std::vector<GroundAhead> grounds_;
  std::shared_ptr<const SweptTrajectory> along_;
  std::vector<Entry> entries_;
  std::vector<std::size_t> ranked_;  ///< entries, best first
  std::vector<std::size_t> left_;    ///< the others, in order
};

}  // namespace mvtp
