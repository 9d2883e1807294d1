#pragma once

#include "planner/geometry/arc.hpp"
#include "planner/geometry/frame.hpp"
#include "planner/geometry/oriented_box.hpp"

namespace mvtp {

/// Footprints may overlap by this much before the planner calls it a collision [m]: half of the
/// referee's tolerance, so that robots which touch from the start can be planned for.
inline constexpr double kTouch = 0.0005;

/// The footprint of a car during one arc, driven evenly while s runs from 0 to 1.
///
/// What collision tests need is kept beside the arc: a circle around all of it, and a bound on the
/// path that any point of the body makes.
class Sweep {
 public:
  Sweep(const Vehicle& vehicle, const Pose& from, const Arc& arc);

  /// This sweep, taken to be in the frame `in`, in the world: the motion of a car that begins
  /// there, if this one begins at the origin. Saves the trigonometry.
  [[nodiscard]] Sweep moved_to(const Frame& in) const;

  /// The footprint at s in [0, 1].
  [[nodiscard]] OrientedBox at(double s) const;

  /// A box that contains the footprint at every s, aligned with the body half way: quick proof that
  /// something is not touched.
  [[nodiscard]] OrientedBox around() const;

  [[nodiscard]] const Point& centre() const { return centre_; }
  /// Radius around centre() of a circle that contains the footprint at every s [m].
  [[nodiscard]] double radius() const { return radius_; }
  /// No point of the body travels further than this per unit of s [m].
  [[nodiscard]] double travel() const { return travel_; }

 private:
  double x_;  ///< rear axle at s = 0
  double y_;
  double ux_;
  double uy_;
  double length_;
  double turn_;   ///< change of heading until s = 1 [rad]
  double ahead_;  ///< of the middle of the body, from the rear axle
  double half_length_;
  double half_width_;
  double travel_;
  double radius_;
  Point centre_;
};

/// Do two footprints overlap by more than kTouch at any equal s?
///
/// Proven by bisection: between two time steps s0 < s1 with gaps g0, g1 the gap is at least
/// (g0 + g1 - travel * (s1 - s0)) / 2. An overlap of up to 1.5 kTouch between the time steps that
/// are looked at may be let through. Cost: a comparison if the circles are apart, else the gap at a
/// few time steps.
[[nodiscard]] bool collide(const Sweep& a, const Sweep& b);

/// Does the footprint overlap a disc, or a fixed box, by more than kTouch at any s?
[[nodiscard]] bool collide(const Sweep& sweep, const Point& centre, double radius);
[[nodiscard]] bool collide(const Sweep& sweep, const OrientedBox& box);

/// The smallest axis-parallel rectangle around a moving point or body [m].
struct Extent {
  double min_x;
  double min_y;
  double max_x;
  double max_y;
};

/// Extent of the rear axle during an arc.
[[nodiscard]] Extent axle_extent(const Pose& from, const Arc& arc);
/// Extent of the whole body during an arc.
[[nodiscard]] Extent body_extent(const Vehicle& vehicle, const Pose& from, const Arc& arc);

}  // namespace mvtp
