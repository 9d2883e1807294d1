#pragma once

#include <optional>
#include <vector>

#include "planner/road.hpp"

namespace mvtp {

/// All that a human driver may do on his way over a junction: at each time he is anywhere between
/// the earliest and the latest motion.
struct Tube {
  SpeedProfile earliest;
  SpeedProfile latest;
};

/// A tube that is kept elsewhere; one motion is a tube without width.
struct TubeView {
  const SpeedProfile& earliest;
  const SpeedProfile& latest;

  TubeView(const SpeedProfile& first, const SpeedProfile& last) : earliest(first), latest(last) {}
  /// Implicit: whoever looks at a tube does not care who keeps it.
  TubeView(const Tube& tube)  // NOLINT(google-explicit-constructor)
      : TubeView(tube.earliest, tube.latest) {}
};

/// What bounds the driver: his vehicle, and how fast he wants to drive where.
struct TubeDriver {
  RoadVehicle road;            ///< `now` and the path
  std::vector<double> limits;  ///< [m/s] that he keeps to, per ReferencePath::kSpacing of the path
  double max_accel = 2.6;      ///< [m/s^2] of the vehicle
  double max_decel = 4.5;      ///< [m/s^2]
  double line = 0.0;           ///< station of his stop line [m]
  /// Stations where those wait inside who yield [m]. SUMO's drivers come to them so slowly that
  /// they could stop, whether or not they will, until they are near.
  std::vector<double> waiting_places = {};
  /// Until this step he may stand there, or inside where he is, since he yields; < 0: to nobody.
  std::int64_t yields_until = -1;
};

/// Whoever is ahead of him in his lane: he follows it.
struct TubeLeader {
  double gap = 0.0;                        ///< [m] from bumper to bumper now
  double speed = 0.0;                      ///< [m/s] now
  double max_accel = 2.6;                  ///< [m/s^2]
  const SpeedProfile* earliest = nullptr;  ///< what it may do; none: it speeds up as it can
  const SpeedProfile* latest = nullptr;    ///< none: it keeps its speed
  /// Until it has driven so far it is ahead of him [m]; then their paths part.
  double until = 1e9;
};

/// The speeds of a driver who takes a share of each limit, and brakes so hard before lower ones
/// [m/s^2].
/// @param limits  [m/s] per ReferencePath::kSpacing of his path
[[nodiscard]] SpeedEnvelope drivers_envelope(std::vector<double> limits, double share,
                                             double braking);

/// How far one of SUMO's drivers still goes who brakes from `speed` [m]: less than a body that is
/// slowed down steadily, as he drives each step as fast as he is at its end (Euler).
/// @param decel  [m/s^2]
/// @param dt     [s] a step
[[nodiscard]] double braking_gap(double speed, double decel, double dt);

/// The tube of a driver who has green, from `step` on, to the end of his path.
///
/// The latest motion behind a leader is Newell's: the leader's own, later by the driver's headway
/// and shorter by the distance at rest [Newell 2002].
[[nodiscard]] Tube predict_tube(const TubeDriver& driver, const std::vector<TubeLeader>& leaders,
                                const DecisionGrid& grid, std::int64_t step);

/// May two drivers meet who do anything inside their tubes, as long as neither is further than its
/// `end` [m]?
/// @param before, behind  steps by which `a` may be earlier and later than its tube says.
[[nodiscard]] bool may_meet(const ContactTable& contacts, const TubeView& a, double a_end,
                            const TubeView& b, double b_end, std::int64_t step, int before = 0,
                            int behind = 0);

}  // namespace mvtp
