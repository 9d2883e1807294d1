#pragma once

#include <cstddef>
#include <vector>

#include "planner/problem/instance.hpp"
#include "planner/problem/plan.hpp"
#include "planner/problem/referee_protocol.hpp"

namespace mvtp::referee {

/// A plan beside its instance: which agent drives which trajectory.
class JudgedPlan {
 public:
  /// Enters into the protocol who has no trajectory, which trajectory belongs to nobody, and poses
  /// that are not finite. Keeps references to both.
  JudgedPlan(const Instance& instance, const Plan& plan, Protocol& protocol);

  [[nodiscard]] const Instance& instance() const { return instance_; }
  [[nodiscard]] double dt() const { return plan_.statistics.dt; }
  [[nodiscard]] const Agent& agent(std::size_t i) const { return instance_.agents[i]; }
  /// @pre the agent has one
  [[nodiscard]] const Trajectory& trajectory(std::size_t i) const { return *trajectories_[i]; }
  /// Agents with a trajectory that can be judged, ascending.
  [[nodiscard]] const std::vector<std::size_t>& present() const { return present_; }

 private:
  const Instance& instance_;
  const Plan& plan_;
  std::vector<const Trajectory*> trajectories_;  ///< by agent; nullptr if it has none
  std::vector<std::size_t> present_;
};

}  // namespace mvtp::referee
