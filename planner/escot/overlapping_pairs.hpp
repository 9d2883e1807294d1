#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "planner/geometry/sweep.hpp"
#include "planner/problem/instance.hpp"

namespace mvtp {

/// The pairs of robots that overlap at their starts or at their goals, and may: from the start
/// until they are apart, from their last approach on at the goals, and never more deeply than
/// there.
///
/// Judged step by step, without memory, as Exemptions does for obstacles.
class OverlappingPairs {
 public:
  /// Finds them, whether the instance allows them or not.
  explicit OverlappingPairs(const Instance& instance);

  [[nodiscard]] bool empty() const { return pairs_.empty(); }
  /// "the starts of agent0 and agent1 overlap", for the first of them; empty if there is none.
  [[nodiscard]] const std::string& first() const { return first_; }

  struct Step {
    int robot;
    Pose from;
    Arc arc;
  };
  /// May the two make these steps at the same time, in which they overlap?
  [[nodiscard]] bool allow(const Step& a, const Step& b) const;
  /// Do the two overlap in these poses, as their starts do?
  [[nodiscard]] bool not_yet_apart(int a, const Pose& pose_a, int b, const Pose& pose_b) const;

 private:
  /// The bodies of the two, smaller by what they overlap.
  struct Cores {
    Vehicle lower;  ///< of the robot with the lower number
    Vehicle higher;
  };
  struct Pair {
    std::optional<Cores> at_start;
    std::optional<Cores> at_goal;
  };

  void find(Pose Agent::*place, std::optional<Cores> Pair::*cores, const char* name);
  [[nodiscard]] Cores cores(int i, int j, Pose Agent::*place) const;
  [[nodiscard]] const Vehicle& vehicle(int i) const {
    return instance_.agents[std::size_t(i)].vehicle;
  }
  [[nodiscard]] bool overlap(int i, const Pose& pose_i, int j, const Pose& pose_j) const;

  const Instance& instance_;
  std::map<std::pair<int, int>, Pair> pairs_;  ///< lower number first
  std::string first_;
};

}  // namespace mvtp
