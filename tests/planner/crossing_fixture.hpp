#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "planner/geometry/oriented_box.hpp"
#include "planner/road/road_scene.hpp"

namespace mvtp {

inline const Vehicle kCar = {.front = 3.6,
                             .rear = 0.9,
                             .width = 1.8,
                             .wheelbase = 2.7,
                             .min_turning_radius = 3.86,
                             .max_speed = 15.0,
                             .max_accel = 2.6,
                             .max_decel = 4.5};

inline ReferencePath straight(Point from, Point to) {
  return ReferencePath(std::vector<Point>{from, to});
}

//            | 1        Path 0 leads east, path 1 north; they cross at the origin, where each has
//            |          s = 100. Path 2 is path 0 again, path 3 runs beside it, 10 m to the south.
//   0, 2 ----+----->
//   3 ------------->
class Crossing : public testing::Test {
 protected:
  Crossing() : library(Margins{}) {
    library.add(straight({-100, 0}, {100, 0}), kCar);
    library.add(straight({0, -100}, {0, 100}), kCar);
    library.add(straight({-100, 0}, {100, 0}), kCar);
    library.add(straight({-100, -10}, {100, -10}), kCar);
    scene.library = &library;
  }

  RoadVehicle& add(int path, double s, double v) {
    RoadVehicle vehicle{.key = std::int64_t(scene.vehicles.size()), .path = path, .now = {s, v}};
    vehicle.envelope = std::make_shared<SpeedEnvelope>(std::vector<double>(801, 13.9), 3.5);
    vehicle.exit_lane = path == 2 ? 0 : path;
    vehicle.s_exit_lane = 110.0;
    vehicle.s_handback = 170.0;
    vehicle.s_end = 190.0;
    scene.vehicles.push_back(vehicle);
    return scene.vehicles.back();
  }

  std::vector<std::int64_t> keys() const {
    std::vector<std::int64_t> all(scene.vehicles.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
  }

  /// Do the true bodies touch at any moment of the two trajectories?
  bool ever_touch(const RoadVehicle& a, const SpeedProfile& ta, const RoadVehicle& b,
                  const SpeedProfile& tb) const {
    std::int64_t end = std::max(ta.end(), tb.end());
    if (ta.complete) end = std::min(end, ta.end());
    if (tb.complete) end = std::min(end, tb.end());
    for (std::int64_t k = scene.step; k < end - 1; ++k) {
      for (double f = 0.0; f < 1.0; f += 0.05) {
        const double s_a = std::lerp(ta.at(k).s, ta.at(k + 1).s, f);
        const double s_b = std::lerp(tb.at(k).s, tb.at(k + 1).s, f);
        if (bodies_touch(a, s_a, b, s_b)) return true;
      }
    }
    return false;
  }

  bool bodies_touch(const RoadVehicle& a, double s_a, const RoadVehicle& b, double s_b) const {
    return gap(a, s_a, b, s_b) < 0.0;
  }
  double gap(const RoadVehicle& a, double s_a, const RoadVehicle& b, double s_b) const {
    return separation(footprint(library.body(a.path), library.path(a.path).at(s_a)),
                      footprint(library.body(b.path), library.path(b.path).at(s_b)));
  }

  /// Somebody else's vehicle that stands at s for ever.
  void add_standing_forecast(int path, double s) {
    RoadVehicle other = add(path, s, 0.0);
    scene.vehicles.pop_back();
    other.key = -1;
    scene.forecasts.push_back({other, {.states = {{s, 0.0}}, .complete = false}});
  }

  PathLibrary library;
  RoadScene scene;
};

}  // namespace mvtp
