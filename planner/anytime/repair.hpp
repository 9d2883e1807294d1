#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "planner/problem/deadline.hpp"
#include "planner/search/joint_motion.hpp"
#include "planner/search/soft_hybrid_astar.hpp"

namespace mvtp {

/// Reproducible on every platform, unlike the distributions of the standard library.
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : engine_(seed) {}

  /// Uniform in 0 ... n - 1. @pre n > 0
  [[nodiscard]] int below(int n) { return int((engine_() >> 32U) * std::uint64_t(n) >> 32U); }
  template <class T>
  void shuffle(std::vector<T>& values) {
    for (int k = int(values.size()) - 1; k > 0; --k) {
      std::swap(values[std::size_t(k)], values[std::size_t(below(k + 1))]);
    }
  }

 private:
  std::mt19937_64 engine_;
};

/// What the repair does. What each value is worth: docs/experiments/planner.md.
struct RepairOptions {
  double soft_cost = 10.0;   ///< of overlapping a robot for one macro step [s]
  double weight = 2.0;       ///< of the cost-to-go
  int expansions = 300;      ///< of one search; the rarer larger ones get through tight places
  int larger_every = 8;      ///< one search in so many may expand ...
  int larger_factor = 8;     ///< ... so many times more
  int tail_percent = 90;     ///< so often only what follows shortly before a conflict is planned
  int tail_macro_steps = 8;  ///< so many macro steps before it at most
  float weight_step = 0.5F;  ///< a pair that stays in conflict becomes so much heavier
  int finer_after = 120;     ///< expansions per robot without progress: some searches are finer
};

/// Plans robots anew, one after the other, until nobody overlaps anybody.
///
/// LNS2 (Li et al. 2022) with neighbourhoods of one robot and the weights of guided local search: a
/// new path is accepted if the weighted number of pairs in conflict does not rise, and pairs that
/// stay in conflict get heavier. Of a pair it is the turn of the robot that was left alone for
/// longer. Which searches are larger is drawn by lot: counted off, they would always fall to the
/// same robot of a last pair. All budgets are in expansions, so that equal seeds give equal
/// results.
class Repair {
 public:
  /// Called now and then; true ends the work under way.
  using Interrupt = std::function<bool()>;

  /// @param motion, alone, deadline  outlive this object
  /// @param alone  the robots' paths if they were alone: of those that find no other
  Repair(JointMotion& motion, const std::vector<ArcTrajectory>& alone, const RepairOptions& options,
         std::uint64_t seed, const Deadline& deadline);

  /// Nobody may arrive later than at this time step.
  void set_limit(int time_step) { limit_ = time_step; }
  [[nodiscard]] std::int64_t expansions() const { return search_.expansions(); }
  [[nodiscard]] SoftHybridAstar& search() { return search_; }

  /// For a search among the others.
  /// @param finely  with smaller cells and slow motion primitives, for tight places
  [[nodiscard]] SoftOptions soft_options(int expansions, bool finely = false) const;
  /// Plans robot i, absent so far, among the others and places it; or leaves it absent.
  /// @param old   nullptr, or the motion that is kept until macro step `from`
  [[nodiscard]] bool plan(int i, const SoftOptions& options, const ArcTrajectory* old = nullptr,
                          int from = 0);

  /// Until no pair is in conflict: true; false when interrupted, out of time, or when so many
  /// expansions have not brought the number of conflicts to a new minimum.
  [[nodiscard]] bool run(std::int64_t stagnation_limit, const Interrupt& interrupt);
  /// Everyone at the goal by `limit`, starting from a plan that takes longer. If false, robots may
  /// be absent or in conflict.
  /// @param expansions   of the search for each robot that would be late
  /// @param unreachable  set if a robot has no path in that time at all, as far as searched
  [[nodiscard]] bool tighten(int limit, std::int64_t stagnation_limit, int expansions,
                             const Interrupt& interrupt, bool& unreachable);
  /// Robot i arrives earlier, if it can without any conflict. @pre no conflicts
  bool shorten(int i, int expansions);

 private:
  struct Choice {
    int robot;
    int from;  ///< the macro step from which it is planned anew
  };

  [[nodiscard]] SoftProblem problem(int i);
  [[nodiscard]] Choice choose();
  void try_one();
  [[nodiscard]] bool plan_anew(const Choice& choice, const ArcTrajectory& old);
  [[nodiscard]] bool drive_alone(int i);
  void put_back(int i, ArcTrajectory old);

  JointMotion& motion_;
  const std::vector<ArcTrajectory>& alone_;
  RepairOptions options_;
  const Deadline& deadline_;
  SoftHybridAstar search_;
  RandomNumbers random_;
  int limit_ = std::numeric_limits<int>::max();
  int tried_ = 0;
  std::vector<int> last_tried_;  ///< by robot, the value of tried_
  bool stagnates_ = false;
};

}  // namespace mvtp
