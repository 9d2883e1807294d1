#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "planner/escot/overlapping_pairs.hpp"
#include "planner/motion/cost_to_go.hpp"
#include "planner/motion/obstacles.hpp"
#include "planner/motion/reeds_shepp.hpp"
#include "planner/motion/stepped_car.hpp"
#include "planner/problem/deadline.hpp"
#include "planner/problem/instance.hpp"

namespace mvtp {

using Configuration = std::vector<Pose>;  ///< one pose per robot, one step

/// An instance made ready to plan for: motion model and cost-to-go of every robot.
///
/// What all algorithms share, so that a comparison is one between algorithms. Not thread safe (the
/// tables fill themselves); does not move, for its parts point at each other.
class PlanningProblem {
 public:
  /// @param instance  outlives this object.
  /// @param deadline  robots that are left when it expires know no path around obstacles: so large
  ///                  a problem is ready soon, but good for nothing any more
  PlanningProblem(const Instance& instance, CollisionRule rule,
                  const Deadline& deadline = Deadline::never());
  PlanningProblem(const PlanningProblem&) = delete;
  PlanningProblem& operator=(const PlanningProblem&) = delete;

  [[nodiscard]] const Instance& instance() const { return instance_; }
  [[nodiscard]] int size() const { return int(cars_.size()); }
  [[nodiscard]] const SteppedCar& car(int i) const { return cars_[std::size_t(i)]; }
  [[nodiscard]] const CostToGo& cost_to_go(int i) const { return costs_to_go_[std::size_t(i)]; }
  [[nodiscard]] const Pose& goal(int i) const { return costs_to_go_[std::size_t(i)].goal(); }
  [[nodiscard]] const Obstacles& obstacles() const { return obstacles_; }
  /// Who overlaps whom at a start or a goal.
  [[nodiscard]] const OverlappingPairs& overlapping_pairs() const { return overlapping_pairs_; }
  /// What of the obstacles does not count for robot i; nullptr: nothing.
  [[nodiscard]] const Exemptions* exemptions(int i) const {
    return exemptions_[std::size_t(i)].get();
  }
  [[nodiscard]] const ReedsShepp& curves() const { return curves_; }
  [[nodiscard]] Configuration starts() const;

  /// Where robot i is after a step. An arc that ends within rounding of the goal ends at the goal.
  [[nodiscard]] Pose after(int i, const Pose& from, const Arc& arc) const {
    return at_goal_or(i, drive(from, arc));
  }
  /// The goal of robot i if `pose` is it but for rounding, or else `pose`.
  [[nodiscard]] Pose at_goal_or(int i, const Pose& pose) const;

  /// The largest over the robots of Reeds-Shepp length / v_max [s]: no plan is shorter.
  [[nodiscard]] double lower_bound() const;

  /// Why nobody can solve the instance: a start or goal that is blocked, or a goal that cannot be
  /// reached even alone, because the gaps on the way are narrower than the vehicle. Empty if that
  /// does not show before the deadline.
  [[nodiscard]] std::string proof_of_infeasibility(const Deadline& deadline) const;

 private:
  [[nodiscard]] std::unique_ptr<const Exemptions> exemptions_of(const Agent& agent) const;
  [[nodiscard]] std::string proof_by_places() const;
  [[nodiscard]] std::string proof_by_passages(const Deadline& deadline) const;

  const Instance& instance_;
  CollisionRule rule_;
  OverlappingPairs overlapping_pairs_;
  Obstacles obstacles_;
  ReedsShepp curves_;
  std::map<double, std::shared_ptr<const ObstacleGrid>> grids_;  ///< by the width of the vehicle
  std::vector<std::unique_ptr<const Exemptions>> exemptions_;
  std::vector<SteppedCar> cars_;
  std::vector<CostToGo> costs_to_go_;
};

}  // namespace mvtp
