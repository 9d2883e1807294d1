#pragma once

#include "coordinator/traffic.hpp"
#include "planner/problem/pose.hpp"
#include "planner/problem/vehicle.hpp"

namespace mvtp {

/// Distance between the footprints of two vehicles [m]; negative: how deep they overlap.
[[nodiscard]] double clearance(const Pose& a, const Vehicle& body_a, const Pose& b,
                               const Vehicle& body_b);

/// A body that goes from one pose to another in one step with a constant twist: straight, on an arc
/// of a circle, or turning on the spot.
class StepMotion {
 public:
  StepMotion(const Pose& from, const Pose& to);

  /// The rear axle after a share `t` of the step, in [0, 1]; exact at both ends.
  [[nodiscard]] Pose at(double t) const;
  /// What the point `ahead` [m] of the rear axle does: its displacement per step, as the vector
  /// that it has at the begin [m].
  [[nodiscard]] Point velocity(double ahead) const;
  [[nodiscard]] double turn() const { return turn_; }  ///< over the step [rad]

 private:
  Pose from_, to_;
  Point heading_;                ///< the unit vector along the body at the begin
  double along_, aside_, turn_;  ///< the twist, in the frame of the body
};

/// When in a step two are nearest, and how near.
struct NearestMoment {
  double t = 1.0;    ///< share of the step
  double gap = 0.0;  ///< [m]; negative: how deep they overlap
};

/// Where two moving vehicles are nearest between `from` and the end of the step. Proven: at no
/// moment are they nearer by more than 0.1 mm or 1 % of what is returned, unless they stay `enough`
/// [m] apart; then any moment farther apart than that may be returned.
[[nodiscard]] NearestMoment nearest_moment(const StepMotion& a, const Vehicle& body_a,
                                           const StepMotion& b, const Vehicle& body_b, double from,
                                           double enough);

/// The same for a vehicle and a person, who walks straight from `before` to where they are.
[[nodiscard]] NearestMoment nearest_moment(const StepMotion& a, const Vehicle& body,
                                           const Point& before, const Pedestrian& person,
                                           double from, double enough);

/// Do two moving vehicles overlap between `from` and the end of the step, when most deeply, and how
/// deep? By the referee's geometry (FCL): of the code above, only the motions and the search are
/// used. Proven: at no moment do they overlap more deeply by more than 0.1 mm or 1 % of what is
/// returned. No overlap: a gap of 0 or more, which says no more than that.
[[nodiscard]] NearestMoment deepest_moment(const StepMotion& a, const Vehicle& body_a,
                                           const StepMotion& b, const Vehicle& body_b, double from);

/// The same for a vehicle and a person, who walks straight from `before` to where they are.
[[nodiscard]] NearestMoment deepest_moment(const StepMotion& a, const Vehicle& body,
                                           const Point& before, const Pedestrian& person,
                                           double from);

}  // namespace mvtp
