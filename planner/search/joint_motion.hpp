#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "planner/motion/motion_primitives.hpp"
#include "planner/problem/deadline.hpp"
#include "planner/search/occupancy.hpp"
#include "planner/search/pair_table.hpp"
#include "planner/search/soft_hybrid_astar.hpp"

namespace mvtp {

/// One robot to be planned for; what it points at outlives its users.
struct MacroRobot {
  const MotionPrimitives* car = nullptr;
  const CostToGo* cost_to_go = nullptr;  ///< names the goal; nullptr: it only stands there
  Pose start;
};

/// The motions of all robots, and which pairs of them overlap at any time.
///
/// Every pair has a weight >= 1, which is what its overlap costs: guided local search raises the
/// weights of pairs that stay in conflict.
class JointMotion {
 public:
  using Pair = std::pair<int, int>;  ///< first < second
  static constexpr int kNoHorizon = std::numeric_limits<int>::max();

  /// All robots are absent.
  explicit JointMotion(std::vector<MacroRobot> robots, TimeGrid time);

  [[nodiscard]] int size() const { return int(robots_.size()); }
  [[nodiscard]] const MacroRobot& robot(int i) const { return robots_[std::size_t(i)]; }
  [[nodiscard]] const TimeGrid& time() const { return time_; }
  [[nodiscard]] const ArcTrajectory& trajectory(int i) const {
    return trajectories_[std::size_t(i)];
  }
  [[nodiscard]] bool present(int i) const { return present_[std::size_t(i)] != 0; }

  /// Robot i, absent so far, moves along `trajectory`.
  void place(int i, ArcTrajectory trajectory);
  /// How many others robot i, absent so far, would overlap on `trajectory`, begun so many macro
  /// steps later; counted up to `most`.
  [[nodiscard]] int overlaps(int i, const ArcTrajectory& trajectory, int most, int wait = 0);
  /// Robot i standing at its start for `wait` macro steps, and then on this way.
  [[nodiscard]] ArcTrajectory trajectory_after(int i, int wait, std::span<const Arc> steps_driven,
                                               bool leaves = false) const;
  /// Robot i, absent so far, drives the path from its start, begun as late as it must so that it
  /// overlaps nobody, but no later than `latest`. @return false if it is absent still
  [[nodiscard]] bool place_later(int i, std::span<const Arc> steps_driven, int latest,
                                 bool leaves = false);
  /// Takes robot i and its conflicts away. @return its trajectory
  ArcTrajectory remove(int i);
  [[nodiscard]] const std::vector<ArcTrajectory>& trajectories() const { return trajectories_; }
  /// Everyone is absent again, and no horizon.
  void clear();
  /// Overlaps from macro step `conflicts` on do not count yet; searches see others until macro step
  /// `horizon`. @pre neither is lower than before, or everyone is absent
  void set_horizon(int conflicts, int lookahead);
  [[nodiscard]] bool has_horizon() const { return horizon_ != kNoHorizon; }
  /// Everyone moves along the given trajectories, one per robot, and no horizon.
  /// @return false if the time ran out; then some are absent
  bool place_all(const std::vector<ArcTrajectory>& trajectories,
                 const Deadline& deadline = Deadline::never());

  struct State {
    std::vector<ArcTrajectory> trajectories;
    int horizon = kNoHorizon;
    int lookahead = kNoHorizon;
  };
  /// To go back to. @pre everyone is present
  [[nodiscard]] State state() const { return {trajectories_, horizon_, lookahead_}; }
  void restore(const State& state);

  [[nodiscard]] const std::vector<Pair>& conflicts() const { return conflicts_; }
  [[nodiscard]] bool in_conflict(int i, int j) const { return position_.at(i, j) > 0; }
  /// The robots that robot i overlaps, ascending.
  [[nodiscard]] std::vector<int> conflicts_of(int i) const;
  /// The first macro step in which robot i overlaps anyone; -1 if it does not.
  [[nodiscard]] int first_conflict(int i);
  [[nodiscard]] double weight(int i, int j) const { return double(weight_of(i, j)); }
  void set_weight(int i, int j, float weight);
  /// Sum of the weights of all pairs in conflict.
  [[nodiscard]] double cost() const { return cost_; }

  /// The others as robot i's search sees them. @pre !present(i)
  /// @param soft-collision cost  of a pair of weight 1 [s]
  [[nodiscard]] OtherRobots others(int i, double soft_cost);

  /// The last time step at which any robot moves.
  [[nodiscard]] int makespan() const;
  /// The sum of the arrivals [time steps].
  [[nodiscard]] std::int64_t flowtime() const;

 private:
  [[nodiscard]] float weight_of(int i, int j) const {
    const float raised = weights_.at(i, j);
    return raised == 0.0F ? 1.0F : raised;
  }
  void add_conflict(int i, int j);
  void drop_conflict(int i, int j);
  /// Calls visitor(j, macro step) for robots that `trajectory`, begun `wait` macro steps later,
  /// overlaps from macro step `from` to the horizon, until it returns false.
  template <class Visitor>
  void for_each_contact(int i, const ArcTrajectory& trajectory, int wait, int from,
                        Visitor&& visitor);

  std::vector<MacroRobot> robots_;
  TimeGrid time_;
  Occupancy occupancy_;
  int horizon_ = kNoHorizon;    ///< of conflicts [macro steps]
  int lookahead_ = kNoHorizon;  ///< of searches [macro steps]
  std::vector<ArcTrajectory> trajectories_;
  std::vector<BoxShape> shapes_;
  std::vector<char> present_;
  PairTable<float> weights_;  ///< 0: still the first one, 1
  PairTable<int> position_;   ///< of a pair in conflicts_, from 1; 0 if it is not in conflict
  std::vector<Pair> conflicts_;
  double cost_ = 0.0;
  std::vector<float> soft_costs_;
  std::vector<int> found_;
  std::vector<char> counted_;
  std::vector<BoxPose> waiting_;  ///< a macro step of time
};

}  // namespace mvtp
