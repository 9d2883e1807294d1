#pragma once

#include <cmath>
#include <numbers>

namespace mvtp {

/// Wraps an angle [rad] to (-pi, pi].
[[nodiscard]] inline double wrap_to_pi(double angle) {
  if (angle > -std::numbers::pi && angle <= std::numbers::pi) return angle;
  const double wrapped = std::remainder(angle, 2.0 * std::numbers::pi);
  return wrapped <= -std::numbers::pi ? wrapped + 2.0 * std::numbers::pi : wrapped;
}

struct Point {
  double x = 0.0;
  double y = 0.0;

  friend bool operator==(const Point&, const Point&) = default;
};

/// Pose of one vehicle in the plane: the frame of its rear-axle centre in the world frame.
///
/// Units: metres and radians; theta is counter-clockwise from +x.
struct Pose {
  double x = 0.0;
  double y = 0.0;
  double theta = 0.0;

  friend bool operator==(const Pose&, const Pose&) = default;
};

/// SE(2) product: the pose `b`, given in the frame of `a`, in the world frame.
[[nodiscard]] inline Pose compose(const Pose& a, const Pose& b) {
  const double c = std::cos(a.theta);
  const double s = std::sin(a.theta);
  return {a.x + c * b.x - s * b.y, a.y + s * b.x + c * b.y, wrap_to_pi(a.theta + b.theta)};
}

/// The pose `b` seen from `a`: compose(a, relative(a, b)) == b.
[[nodiscard]] inline Pose relative(const Pose& a, const Pose& b) {
  const double c = std::cos(a.theta);
  const double s = std::sin(a.theta);
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  return {c * dx + s * dy, -s * dx + c * dy, wrap_to_pi(b.theta - a.theta)};
}

[[nodiscard]] inline double distance(const Pose& a, const Pose& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

/// The pose after driving `length` [m] (negative: in reverse) along an arc of signed `curvature`
/// [1/m] (positive: to the left). Exact: no Euler step of eq. (5) of the ESCoT paper.
[[nodiscard]] inline Pose drive(const Pose& from, double length, double curvature) {
  const double turn = length * curvature;
  // sin(a)/a and (1-cos(a))/a are exact for a -> 0 through their series.
  const double a = turn;
  const double along = std::abs(a) < 1e-4 ? 1.0 - a * a / 6.0 : std::sin(a) / a;
  const double aside = std::abs(a) < 1e-4 ? a / 2.0 - a * a * a / 24.0 : (1.0 - std::cos(a)) / a;
  return compose(from, {length * along, length * aside, turn});
}

}  // namespace mvtp
