#pragma once

#include <cstdint>
#include <vector>

#include "planner/anytime/repair.hpp"
#include "planner/problem/deadline.hpp"
#include "planner/search/joint_motion.hpp"

namespace mvtp {

/// A plan for all robots from their single-agent paths, whatever its makespan.
///
/// 1. One after the other, those with the longest path first, robots are placed by a search that
///    may drive through others at a soft-collision cost. In a crowd, where very many of those paths
///    overlap, they drive these instead, begun when they meet fewest, and what follows is done
///    window by window of time.
/// 2. What overlaps is repaired, within a makespan bound.
/// 3. When that stagnates, robots go by revised prioritized planning (RevisedPrioritizedPlanning),
///    and those left without a path are placed as in 1 and repaired. If this fails too, the bound
///    is relaxed, again and again; in
///    a crowd it is so first, and by little.
class FirstPlan {
 public:
  /// All parameters outlive this object. @param alone  the robots' paths if they were alone
  FirstPlan(JointMotion& motion, Repair& repair, const std::vector<ArcTrajectory>& alone,
            const Deadline& deadline, Repair::Interrupt interrupt);

  /// True if all robots have a motion and nobody overlaps; false when interrupted or out of time.
  [[nodiscard]] bool find();

 private:
  /// What differs in a crowd.
  struct FirstPlanOptions {
    double limit;                   ///< of all arrivals at first, in longest single-agent paths
    double relax;                   ///< the limit becomes so much later at every stagnation ...
    std::int64_t stagnation_limit;  ///< ... after so many expansions per robot without progress
    int stagnations;  ///< so many on end before robots go by revised prioritized planning ...
    int robots_per_stagnation;  ///< ... and one more for so many: its time grows with their square
  };
  static constexpr FirstPlanOptions kCalm{1.2, 1.25, 750, 1, 100};
  static constexpr FirstPlanOptions kCrowded{1.25, 1.05, 150, 4, 50};

  [[nodiscard]] bool place_one_by_one();
  [[nodiscard]] bool spread_out();
  [[nodiscard]] bool resolve();
  [[nodiscard]] bool revise_priorities();
  [[nodiscard]] std::vector<int> longest_path_first() const;
  void plan_softly(int i);
  void set_limit(double limit);
  [[nodiscard]] bool over() const { return deadline_.expired() || interrupt_(); }

  JointMotion& motion_;
  Repair& repair_;
  const std::vector<ArcTrajectory>& alone_;
  const Deadline& deadline_;
  Repair::Interrupt interrupt_;
  FirstPlanOptions options_ = kCalm;
  double limit_ = 0.0;  ///< of all arrivals [time steps]
  bool revised_ = false;
};

}  // namespace mvtp
