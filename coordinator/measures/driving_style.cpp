#include "coordinator/measures/driving_style.hpp"

#include <algorithm>
#include <cmath>

namespace mvtp {

void DrivingStyle::observe(double time, std::span<const Observation> vehicles,
                           std::span<const char> resting) {
  for (std::size_t i = 0; i < vehicles.size(); ++i) {
    const VehicleState& v = *vehicles[i].state;
    const auto [found, is_new] = tracks_.try_emplace(v.id);
    Track& t = found->second;
    if (is_new) {
      t.window_began = time;
      t.speed_then = v.speed;
    }
    if (const double span = time - t.window_began; span >= kWindow - 1e-6) {
      const double accel = (v.speed - t.speed_then) / span;
      if (t.has_accel) {
        const double jerk = (accel - t.accel) / span;
        t.squares += jerk * jerk;
        ++t.windows;
      }
      t.accel = accel;
      t.has_accel = true;
      t.window_began = time;
      t.speed_then = v.speed;
    }
    if (resting[i] != 0 || v.speed >= kRest) {
      t.rest_began = -1.0;
      t.was_moving = resting[i] == 0 && (t.was_moving || v.speed >= kMoving);
      continue;
    }
    if (t.rest_began < 0.0) t.rest_began = time;
    if (t.was_moving) ++t.figures.stops;
    t.was_moving = false;
    t.figures.standing = std::max(t.figures.standing, time - t.rest_began);
  }
}

std::map<std::string, DrivingFigures> DrivingStyle::figures() const {
  std::map<std::string, DrivingFigures> all;
  for (const auto& [id, t] : tracks_) {
    DrivingFigures& figures = all[id] = t.figures;
    if (t.windows > 0) figures.jerk = std::sqrt(t.squares / t.windows);
  }
  return all;
}

}  // namespace mvtp
