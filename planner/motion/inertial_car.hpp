#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "planner/motion/reference_path.hpp"

namespace mvtp {

/// State of a car on its reference path that cannot change its speed at will: x, y, theta, v of the
/// model `InertialCar`, with the pose given by the path. Never reverses: v >= 0.
struct InertialState {
  double s = 0.0;  ///< rear axle along the reference path [m]
  double v = 0.0;  ///< [m/s]

  friend bool operator==(const InertialState&, const InertialState&) = default;
};

/// Slower than this a car stands: rounding must not leave one that creeps on for ever [m/s].
inline constexpr double kAtRest = 1e-9;

/// The state after `h` seconds at constant acceleration `a`. A car that comes to rest within that
/// time stays there, at exactly v == 0.
[[nodiscard]] inline InertialState advance(const InertialState& from, double a, double h) {
  const double v = from.v + a * h;
  if (a >= 0.0 || v >= kAtRest) return {from.s + h * (from.v + 0.5 * a * h), v};
  return {from.s + 0.5 * from.v * std::min(h, from.v / -a), 0.0};
}

/// The number of steps of `h` seconds in which a car with speed `v` comes to rest, braking with
/// `b` > 0; at most kMostBrakingSteps.
inline constexpr int kMostBrakingSteps = 100000;
[[nodiscard]] inline int braking_steps(double v, double b, double h) {
  return int(std::clamp(std::ceil((v - kAtRest) / (b * h)), 0.0, double(kMostBrakingSteps)));
}

/// How far the car rolls while it brakes to rest with deceleration `b` > 0 [m].
[[nodiscard]] inline double stopping_distance(double v, double b) { return v * v / (2.0 * b); }

/// Position after braking with deceleration `b` for `tau` seconds from `from`.
[[nodiscard]] inline double braked_position(const InertialState& from, double b, double tau) {
  const double moving = std::min(tau, from.v / b);
  return from.s + moving * (from.v - 0.5 * b * moving);
}

/// The highest speed at each position of a reference path that a driver may have.
class SpeedEnvelope {
 public:
  /// @param limits  one speed limit [m/s] per ReferencePath::kSpacing metres of the path.
  /// @param braking deceleration [m/s^2] with which every lower limit ahead must be reachable.
  SpeedEnvelope(std::vector<double> limits, double braking) : limits_(std::move(limits)) {
    for (std::size_t i = limits_.size() - 1; i-- > 0;) {
      const double reachable =
          std::sqrt(limits_[i + 1] * limits_[i + 1] + 2.0 * braking * ReferencePath::kSpacing);
      limits_[i] = std::min(limits_[i], reachable);
    }
  }

  /// [m/s] at s; the nearest value beyond the ends.
  [[nodiscard]] double at(double s) const {
    const double cell = std::clamp(s / ReferencePath::kSpacing, 0.0, double(limits_.size() - 1));
    const auto i = std::size_t(cell);
    const std::size_t j = std::min(i + 1, limits_.size() - 1);
    return limits_[i] + (cell - double(i)) * (limits_[j] - limits_[i]);
  }

 private:
  std::vector<double> limits_;
};

}  // namespace mvtp
