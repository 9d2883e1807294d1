#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "planner/search/moving_obstacle.hpp"

namespace mvtp {

/// Robots on their ways, looked up by time: which of them does a sweep of step t touch?
///
/// The circles around all sweeps of one step are sorted by x, so that only robots in a strip of the
/// map are looked at.
class TimedObstacles {
 public:
  static constexpr int kForEver = std::numeric_limits<int>::max();

  TimedObstacles() = default;
  /// @param robots  outlive this object.
  /// @param until   nobody is looked at from this step on.
  explicit TimedObstacles(std::span<const MovingObstacle* const> robots, int until = kForEver);

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
  template <class Visit>
  void for_each_near(const Sweep& sweep, int t, const Visit& visit) const;

  std::vector<const MovingObstacle*> robots_;
  std::vector<Circle> circles_;  ///< of step t from t * robots_.size() on, ordered by x
  double largest_ = 0.0;         ///< radius [m]
  int end_ = 0;
  int until_ = kForEver;
};

}  // namespace mvtp
