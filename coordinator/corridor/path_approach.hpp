#pragma once

#include <cmath>
#include <span>

#include "coordinator/network/drivable_area.hpp"
#include "planner/geometry.hpp"

namespace mvtp {

/// How a vehicle that stands beside its path gets onto it: the sideways distance fades out over
/// some metres, with the slope that its heading has at first, so that the rear axle always moves
/// along its heading.
class PathApproach {
 public:
  PathApproach() = default;
  /// @param pose  of the rear axle where the approach begins.
  /// @param near  about the place on the path abreast of it [m].
  PathApproach(const ReferencePath& path, const Pose& pose, double near);

  /// The place on the path abreast of the pose that it began from [m].
  [[nodiscard]] double begin() const { return begin_; }
  /// The rear axle when it has come to `s` on the path.
  [[nodiscard]] Pose pose(const ReferencePath& path, double s) const;
  /// How far off the path it begins [m].
  [[nodiscard]] double aside() const { return std::abs(aside_); }
  /// Does it begin so far off the path that driving it differs from driving the path?
  [[nodiscard]] bool is_notable() const;
  /// The share of `accel` [m/s^2] that the vehicle may use along the path, so that its speed over
  /// the ground changes by no more than `accel`; at most 1, and negative where none is left.
  /// @param speed   where the approach begins [m/s]
  /// @param limits  [m/s] per ReferencePath::kSpacing of the path
  [[nodiscard]] double acceleration_share(const ReferencePath& path, double speed, double accel,
                                          std::span<const double> limits) const;
  /// Can the body drive it: within its turning circle, and with its footprint where `area` allows?
  [[nodiscard]] bool is_drivable(const ReferencePath& path, const Vehicle& body,
                                 const DrivableArea& area) const;
  /// Does it begin so aslant that it would swing far off the path?
  [[nodiscard]] bool is_aslant() const;

 private:
  double begin_ = 0.0;
  double length_ = 1.0;  ///< [m] of path until it is reached
  double aside_ = 0.0;   ///< [m] at first, and
  double slope_ = 0.0;   ///< per metre of path
};

}  // namespace mvtp
