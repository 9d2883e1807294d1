#pragma once

#include <map>
#include <span>
#include <string>

#include "coordinator/audit/audit.hpp"

namespace mvtp {

/// How one vehicle drove.
struct DrivingFigures {
  int stops = 0;          ///< times that it came to rest, out of at least 5 km/h
  double jerk = 0.0;      ///< [m/s^3] root mean square over its trip; see DrivingStyle
  double standing = 0.0;  ///< [s] the longest time at rest
};

/// Watches how smoothly each vehicle drives, whoever drives it, from the speeds that the traffic
/// shows. Accelerations are means over half a second, the jerk is their change from one half second
/// to the next: finer than that, the steps of a simulation show more than the driving.
class DrivingStyle {
 public:
  static constexpr double kWindow = 0.5;        ///< [s]
  static constexpr double kRest = 0.1;          ///< [m/s] below this a vehicle stands
  static constexpr double kMoving = 5.0 / 3.6;  ///< [m/s] it must have had before the next stop

  /// After each step of the traffic. @param resting  1 for each that is at a scheduled stop
  void observe(double time, std::span<const Observation> vehicles, std::span<const char> resting);

  /// By id, of every vehicle ever seen.
  [[nodiscard]] std::map<std::string, DrivingFigures> figures() const;

 private:
  struct Track {
    double window_began = 0.0;  ///< [s]
    double speed_then = 0.0;    ///< [m/s]
    bool has_accel = false;
    double accel = 0.0;  ///< of the last whole window [m/s^2]
    double squares = 0.0;
    int windows = 0;
    bool was_moving = false;
    double rest_began = -1.0;  ///< [s]; < 0: it moves
    DrivingFigures figures;
  };
  std::map<std::string, Track> tracks_;
};

}  // namespace mvtp
