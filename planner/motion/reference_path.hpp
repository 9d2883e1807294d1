#pragma once

#include <span>
#include <vector>

#include "planner/problem/pose.hpp"

namespace mvtp {

/// The poses of a vehicle, by s [m].
///
/// Mostly a smooth curve that the rear axle follows, and s its arc length. The vehicle's heading is
/// the tangent, so a curvature within 1 / R_min is all that a car-like vehicle needs to follow it
/// exactly.
class ReferencePath {
 public:
  static constexpr double kSpacing = 0.25;  ///< [m] between samples

  /// The curve through `points` (at least two, no two neighbours equal), resampled evenly.
  explicit ReferencePath(std::span<const Point> points);

  /// These poses (at least two), of a body that does not keep to its tangent, at every kSpacing of
  /// s: whatever that measures.
  explicit ReferencePath(std::vector<Pose> poses);

  [[nodiscard]] double length() const { return kSpacing * double(poses_.size() - 1); }
  [[nodiscard]] std::size_t samples() const { return poses_.size(); }
  [[nodiscard]] const Pose& sample(std::size_t i) const { return poses_[i]; }

  /// The rear-axle pose at s; beyond either end on the tangent there.
  [[nodiscard]] Pose at(double s) const;
  /// Signed curvature [1/m] at s, positive to the left; 0 beyond the ends.
  [[nodiscard]] double curvature(double s) const;
  [[nodiscard]] double max_abs_curvature() const;
  /// The most that the rear axle moves from one sample to the next [m]; at least kSpacing.
  [[nodiscard]] double longest_step() const { return longest_step_; }
  /// The s of the place nearest to `p` among those within [from, to].
  [[nodiscard]] double project(const Point& p, double from, double to) const;

 private:
  void set_curvatures();

  std::vector<Pose> poses_;
  std::vector<double> curvatures_;
  double longest_step_ = kSpacing;
};

/// The polyline resampled at `spacing` [m], first and last point kept.
[[nodiscard]] std::vector<Point> resample(std::span<const Point> polyline, double spacing);

/// The polyline smoothed by a Gaussian of standard deviation `sigma` [m] along its arc length; it
/// is continued straight beyond both ends, so that straight ends stay where they are.
[[nodiscard]] std::vector<Point> smooth(std::span<const Point> polyline, double sigma);

/// The same for points that are `spacing` apart: one point for each.
[[nodiscard]] std::vector<Point> smooth_even(std::span<const Point> points, double spacing,
                                             double sigma);

}  // namespace mvtp
