#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "planner/problem/pose.hpp"
#include "planner/problem/vehicle.hpp"

namespace mvtp {

/// The state at the end of a step, with the speed v [m/s] (negative: reverse) and the steering
/// angle phi [rad] held constant during the step: an arc of curvature tan(phi) / wheelbase, or a
/// wait.
struct Waypoint {
  Pose pose;
  double v = 0.0;
  double phi = 0.0;

  friend bool operator==(const Waypoint&, const Waypoint&) = default;
};

/// The motion of one vehicle as waypoints at steps t = 0, 1, ..., makespan().
///
/// Never empty; the vehicle rests at its last pose for ever: at(t) is defined for every t >= 0, so
/// callers never pad trajectories to a common length.
class Trajectory {
 public:
  explicit Trajectory(const Pose& start) : waypoints_{{start}} {}
  /// @pre !waypoints.empty()
  explicit Trajectory(std::vector<Waypoint> waypoints) : waypoints_(std::move(waypoints)) {
    assert(!waypoints_.empty());
  }

  void push_back(const Waypoint& waypoint) { waypoints_.push_back(waypoint); }
  /// Drops everything after step t. @pre t <= makespan()
  void truncate(std::size_t t) {
    waypoints_.erase(waypoints_.begin() + std::ptrdiff_t(t) + 1, waypoints_.end());
  }

  [[nodiscard]] std::size_t makespan() const { return waypoints_.size() - 1; }
  [[nodiscard]] const Waypoint& at(std::size_t t) const {
    return waypoints_[std::min(t, makespan())];
  }
  [[nodiscard]] const std::vector<Waypoint>& waypoints() const { return waypoints_; }

  friend bool operator==(const Trajectory&, const Trajectory&) = default;

 private:
  std::vector<Waypoint> waypoints_;
};

/// Ends of a solver run.
enum class Status {
  kSolved,
  kTimeout,     ///< the time limit ended the search
  kExhausted,   ///< the search gave up before the limit: step limit or no move left
  kInfeasible,  ///< proven: a start or goal is blocked, or a goal cannot be reached even alone
};

[[nodiscard]] constexpr const char* to_string(Status status) {
  switch (status) {
    case Status::kSolved:
      return "solved";
    case Status::kTimeout:
      return "timeout";
    case Status::kExhausted:
      return "exhausted";
    case Status::kInfeasible:
      return "infeasible";
  }
  return "";
}

struct Statistics {
  std::string status;  ///< to_string(Status)
  std::string algorithm;
  std::string pbcr;       ///< "paper": PBCR ranked by the paper's score; else empty
  double cost = 0.0;      ///< sum of arrival times [s]; flowtime is the same figure
  double makespan = 0.0;  ///< [s]
  double flowtime = 0.0;  ///< [s]
  double runtime = 0.0;   ///< [s]
  /// When the first valid plan was there [s], by algorithms that go on to improve it; nullopt: the
  /// plan is the first, and `runtime` says when.
  std::optional<double> first_solution;
  std::size_t makespan_steps = 0;
  double lower_bound = 0.0;             ///< [s]; see metrics.hpp
  std::optional<double> solo_makespan;  ///< [s]
  std::uint64_t seed = 0;
  double dt = 1.0;  ///< [s]
  std::string version;
  std::string reason;  ///< why not solved; empty if solved
  /// What is exempt from the collision rule; see exemptions_of().
  std::vector<std::string> initial_overlaps;
};

/// One trajectory per agent, in the order of the instance.
struct Plan {
  Statistics statistics;
  std::vector<std::string> names;
  std::vector<Trajectory> trajectories;
  std::vector<Vehicle> vehicles{};  ///< one for each name; empty if the plan does not say
};

}  // namespace mvtp
