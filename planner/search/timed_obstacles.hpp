#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "planner/search/swept_trajectory.hpp"

namespace mvtp {

/// All that a robot can touch: a circle that grows while it drives.
struct Reach {
  Point from;
  double at_start = 0.0;  ///< radius at time 0 [m]
  double per_step = 0.0;  ///< [m]
};

/// Robots on their paths, looked up by time: which of them does a sweep of step t touch?
///
/// The circles around all sweeps of one step are sorted by x, so that only robots in a strip of the
/// map are looked at.
class TimedObstacles {
 public:
  static constexpr int kForEver = std::numeric_limits<int>::max();

  TimedObstacles() = default;
  /// @param robots  outlive this object.
  /// @param until   nobody is looked at from this step on.
  /// @param askers  whose sweeps will be asked about; nobody out of their reach is kept in mind.
  ///                Empty: anybody's.
  explicit TimedObstacles(std::span<const SweptTrajectory* const> robots, int until = kForEver,
                          std::span<const Reach> askers = {});

  [[nodiscard]] bool empty() const { return robots_.empty(); }
  /// From this step on everybody rests, or is not looked at.
  [[nodiscard]] int end() const { return end_; }

  /// Does `sweep`, driven during step t >= 0, collide with anybody?
  [[nodiscard]] bool hit(const Sweep& sweep, int t) const;
  /// With how many?
  [[nodiscard]] int count(const Sweep& sweep, int t) const;

 private:
  struct Circle {
    double x;
    double y;
    double radius;
    int robot;
  };
  template <class Visitor>
  void for_each_near(const Sweep& sweep, int t, const Visitor& visitor) const;

  std::vector<const SweptTrajectory*> robots_;
  std::vector<Circle> circles_;    ///< of all steps, those of one step ordered by x
  std::vector<std::size_t> rows_;  ///< where the circles of step t begin, and the last ones end
  double largest_ = 0.0;           ///< radius [m]
  int end_ = 0;
  int until_ = kForEver;
};

}  // namespace mvtp
