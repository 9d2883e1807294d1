#pragma once

/// What the referee lets pass, besides touches (kTouchTolerance).
namespace mvtp::referee {

inline constexpr double kGoalTolerance = 0.1;    ///< [m] and [rad]
inline constexpr double kStartTolerance = 1e-3;  ///< [m] and [rad]; peers write six digits
inline constexpr double kFarthest = 1e6;         ///< [m]; beyond, double loses the millimetre

/// How far a step may end from the arc that its v and phi say [m] and [rad].
inline constexpr double kStatedArcTolerance = 1e-4;
/// The same for a step without v and phi: room for poses that were written with six digits, and in
/// length [m] and turn [rad] against the limits of the vehicle.
inline constexpr double kJoiningArcTolerance = 1.5e-3;
inline constexpr double kLimitTolerance = 1e-6;  ///< relative, of speed and curvature

}  // namespace mvtp::referee
