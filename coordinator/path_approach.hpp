#pragma once

#include "coordinator/drivable_area.hpp"
#include "planner/motion/reference_path.hpp"

namespace mvtp {

/// How a vehicle that stands beside its path gets onto it: the sideways distance fades out over some
/// metres, with the slope that its heading has at first, so that the rear axle always moves along its
/// heading.
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
  /// Does it begin so far off the path that driving it differs from driving the path?
  [[nodiscard]] bool is_notable() const;
  /// What the speed over the ground changes at most, beside what it changes along the path [m/s^2].
  [[nodiscard]] double ground_acceleration(const ReferencePath& path, double speed) const;
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
