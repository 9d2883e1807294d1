#pragma once

#include <cstdint>
#include <vector>

#include "planner/algorithms/joint_motion.hpp"
#include "planner/algorithms/repair.hpp"
#include "planner/problem/deadline.hpp"

namespace mvtp {

/// A plan for all robots from their ways alone, whatever its makespan.
///
/// 1. One after the other, those with the longest way first, robots are placed by a search that may
///    drive through others at a price. Where very many ways alone overlap, all start from these
///    instead, and what follows is done window by window of time.
/// 2. What overlaps is repaired, within a deadline for all.
/// 3. When that comes to a halt, robots take turns (TakingTurns), and those left without a way are
///    placed as in 1 and repaired. If this fails too, the deadline is put off, again and again.
class FirstPlan {
 public:
  /// All parameters outlive this object. @param alone  the robots' ways if they were alone
  FirstPlan(JointMotion& motion, Repair& repair, const std::vector<TimedTrack>& alone,
            const Deadline& deadline, Repair::Interrupt interrupt);

  /// True if all robots have a motion and nobody overlaps; false when interrupted or out of time.
  [[nodiscard]] bool find();

 private:
  [[nodiscard]] bool place_one_by_one();
  [[nodiscard]] bool resolve();
  [[nodiscard]] bool resolve_by_windows();
  [[nodiscard]] bool take_turns();
  [[nodiscard]] int longest_way_alone() const;
  void plan_softly(int i);
  void set_limit(double limit);
  [[nodiscard]] std::int64_t patience() const;
  [[nodiscard]] bool over() const { return deadline_.expired() || interrupt_(); }

  JointMotion& motion_;
  Repair& repair_;
  const std::vector<TimedTrack>& alone_;
  const Deadline& deadline_;
  Repair::Interrupt interrupt_;
  double limit_ = 0.0;  ///< of all arrivals [instants]
  bool turns_taken_ = false;
};

}  // namespace mvtp
