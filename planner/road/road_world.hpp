#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "planner/escot/generate_config.hpp"
#include "planner/road/road_escot.hpp"

namespace mvtp {

/// The world of PBCR on roads: a motion is one decision's acceleration and full braking after it.
///
/// Keep-clear: candidates after which a vehicle could not stand clear of the complete plans of
/// others, and of the paths of those without one, come last, since all-brake alone is safe
/// but ends in gridlock.
class RoadStepWorld {
 public:
  using State = InertialState;
  struct Motion {
    InertialState from;
    double acceleration = 0.0;
    InertialState to;

    friend bool operator==(const Motion&, const Motion&) = default;
  };

  /// @param complete  the plans of those who have one.
  /// @param complete_plans  without one nobody drives over a stop line; false: nobody has one, and
  ///     those of lower priority keep clear of the others.
  RoadStepWorld(const RoadPairs& pairs, const JointPlan& complete, const ProfileOptions& options,
                bool complete_plans = true);

  /// Robots are numbered as the scene's vehicles.
  [[nodiscard]] std::vector<Motion> candidates(int i, const State& state) const;
  [[nodiscard]] Motion safe_stop(int i, const State& state) const;
  [[nodiscard]] bool conflict(int i, const Motion& a, int j, const Motion& b) const;
  [[nodiscard]] std::span<const int> near(int i) const { return near_[std::size_t(i)]; }

 private:
  [[nodiscard]] bool is_clear_of_earlier(int i, double rest) const;
  [[nodiscard]] bool is_clear_of_those_without_plan(int i, double rest) const;
  [[nodiscard]] const RoadScene& scene() const { return pairs_.scene(); }
  [[nodiscard]] const RoadVehicle& vehicle(int i) const { return scene().vehicles[std::size_t(i)]; }

  const RoadPairs& pairs_;
  const JointPlan& complete_;
  const ProfileOptions& options_;
  bool complete_plans_;
  std::vector<std::vector<int>> near_;
};

/// The world of generate_config() on roads: one group of vehicles whose paths may still meet.
///
/// GetOptTraj: complete speed profiles in a searched order (plan_crossing), of all that find one.
/// The rest: PBCR over accelerations, around the complete plans.
class RoadWorld {
 public:
  using State = RoadStepWorld::State;
  using Motion = RoadStepWorld::Motion;

  /// @param keys  the group, the highest priority first.
  /// @param incumbent  what its vehicles follow now.
  RoadWorld(const RoadPairs& pairs, std::vector<std::int64_t> keys, JointPlan incumbent,
            const RoadEscotOptions& options, std::uint64_t seed, WorkBudget work);
  RoadWorld(const RoadWorld&) = delete;  // steps_ refers to found_
  RoadWorld& operator=(const RoadWorld&) = delete;

  /// Of all vehicles, in the scene's order.
  [[nodiscard]] std::vector<State> states() const;
  /// Do these motions, one per vehicle, begin all that get_opt_traj() has found?
  [[nodiscard]] bool keeps_plans(const std::vector<Motion>& motions) const;
  /// What get_opt_traj() has found.
  [[nodiscard]] const CrossingResult& found() const { return found_; }

  // StepWorld
  [[nodiscard]] std::vector<Motion> candidates(int i, const State& state) const {
    return steps_.candidates(i, state);
  }
  [[nodiscard]] Motion safe_stop(int i, const State& state) const {
    return steps_.safe_stop(i, state);
  }
  [[nodiscard]] bool conflict(int i, const Motion& a, int j, const Motion& b) const {
    return steps_.conflict(i, a, j, b);
  }
  [[nodiscard]] std::span<const int> near(int i) const { return steps_.near(i); }

  // GroupWorld
  [[nodiscard]] std::vector<Group> group_robots(const std::vector<State>& q) const;
  /// Instead of the size of a group its work is bounded.
  [[nodiscard]] bool pre_check(const Group& /*group*/) const { return options_.plans_groups; }
  [[nodiscard]] std::vector<std::optional<Motion>> get_opt_traj(const std::vector<State>& q,
                                                                const Group& group);
  /// The longest in the control zone first.
  [[nodiscard]] std::vector<int> order(const std::vector<State>& q) const;

 private:
  [[nodiscard]] const RoadScene& scene() const { return pairs_.scene(); }
  /// The motion that a profile makes during the decision of now.
  [[nodiscard]] Motion first_motion(const SpeedProfile& profile) const;

  const RoadPairs& pairs_;
  std::vector<std::int64_t> keys_;
  JointPlan incumbent_;
  const RoadEscotOptions& options_;
  std::uint64_t seed_;
  WorkBudget work_;
  CrossingResult found_;
  RoadStepWorld steps_;
};

}  // namespace mvtp
