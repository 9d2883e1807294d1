// Which drivers keep behind a vehicle that is ahead of them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "planner/road/road_contact.hpp"
#include "tests/planner/crossing_fixture.hpp"

namespace mvtp {
namespace {

//   A vehicle comes over from the next lane into that of a driver.
class ComesOver : public Crossing {
 protected:
  ComesOver() {
    path_ = library.add(
        ReferencePath(std::vector<Point>{{-100, -3.2}, {-18, -3.2}, {18, 0.0}, {100, 0.0}}), kCar);
  }

  /// Do their bodies touch if both brake now as hard as they can?
  [[nodiscard]] bool touch_braking(const RoadVehicle& a, const RoadVehicle& b) const {
    const auto at = [](const RoadVehicle& v, double t) {
      const double braked = std::min(t, v.now.v / kCar.max_decel);
      return v.now.s + v.now.v * braked - 0.5 * kCar.max_decel * braked * braked;
    };
    for (double t = 0.0; t < 4.0; t += 0.05) {
      if (bodies_touch(a, at(a, t), b, at(b, t))) return true;
    }
    return false;
  }

  int path_ = 0;
};

TEST_F(ComesOver, WhoCannotStopBehindItDoesNotFollowIt) {
  int follow = 0;
  int cannot_stop = 0;
  for (double s = 80.0; s <= 125.0; s += 1.0) {
    for (double other = 50.0; other < s; other += 1.0) {
      for (const double v : {2.0, 6.0, 13.0}) {
        scene.vehicles.clear();
        const RoadVehicle driver = add(0, other, v);
        scene.vehicles.clear();
        const RoadVehicle vehicle = add(path_, s, 1.0);
        scene.forecasts = {{.vehicle = driver, .earliest = {.states = {driver.now}}}};
        const bool in_lane = drives_ahead(library, {path_, s}, {0, other});
        const bool follows = RoadPairs(scene).follows(0, 0);
        follow += follows && !in_lane ? 1 : 0;
        if (in_lane || !touch_braking(vehicle, driver)) continue;
        ++cannot_stop;
        EXPECT_FALSE(follows) << s << ' ' << other << ' ' << v;
      }
    }
  }
  EXPECT_GT(follow, 100);
  EXPECT_GT(cannot_stop, 100);
}

// Each would wait for the other one for good: the driver has to follow, also one who is not
// expected to yield to who blocks him.
TEST_F(ComesOver, WhoStandsBecauseOfItFollowsIt) {
  int held_up = 0;
  for (double s = 80.0; s <= 125.0; s += 0.5) {
    for (double other = s - 8.0; other < s; other += 0.5) {
      const auto follows = [&](double v) {
        scene.vehicles.clear();
        const RoadVehicle driver = add(0, other, v);
        scene.vehicles.clear();
        const RoadVehicle vehicle = add(path_, s, 0.0);
        scene.forecasts = {
            {.vehicle = driver, .earliest = {.states = {driver.now}}, .yields = false}};
        const RoadPairs pairs(scene);
        const bool blocks = pairs.towards_forecast(0, 0).contact->is_ahead(vehicle.now, driver.now);
        held_up += blocks && v == 0.0 ? 1 : 0;
        const bool in_lane = drives_ahead(library, {path_, s}, {0, other});
        if (blocks && v == 0.0) {
          EXPECT_TRUE(pairs.follows(0, 0)) << s << ' ' << other;
        }
        if (!blocks || (v > 0.0 && !in_lane)) {
          EXPECT_FALSE(pairs.follows(0, 0)) << s << ' ' << other << ' ' << v;
        }
      };
      follows(0.0);
      follows(1.0);
    }
  }
  EXPECT_GT(held_up, 100);
}

//   It turns off to the north before a driver who goes straight on.
class TurnsOff : public Crossing {
 protected:
  TurnsOff() {
    std::vector<Point> turn = {{-100, 0}, {-8, 0}};
    for (double a = 0.1; a < 1.5; a += 0.1) {
      turn.push_back({8 * std::sin(a) - 8, 8 - 8 * std::cos(a)});
    }
    turn.push_back({0, 100});
    path_ = library.add(ReferencePath(turn), kCar);
  }

  /// Its rear axle is at `s`, its line is at 90 m; he is 8 m behind it.
  /// @param between  rear axle on lanes between two junctions, from and to [m].
  [[nodiscard]] bool is_followed(double s, Told told, int path,
                                 const std::vector<std::pair<double, double>>& between = {}) {
    scene.vehicles.clear();
    const RoadVehicle driver = add(0, s - 8.0, 5.0);
    scene.vehicles.clear();
    RoadVehicle& ours = add(path, s, 3.0);
    ours.stop_lines = {90.0};
    ours.between = between;
    scene.forecasts = {
        {.vehicle = driver, .earliest = {.states = {driver.now}}, .yields = false, .told = told}};
    return RoadPairs(scene).follows(0, 0);
  }

  int path_ = 0;
};

// SUMO's drivers then heed nobody on another lane inside a junction: its tail is still in his path.
TEST_F(TurnsOff, WhoIsToldToPassDoesNotFollowItOnTheJunction) {
  EXPECT_FALSE(is_followed(92.0, Told::kToPass, path_));
  EXPECT_TRUE(is_followed(88.0, Told::kToPass, path_)) << "before its line";
  EXPECT_TRUE(is_followed(92.0, Told::kNothing, path_));
  EXPECT_TRUE(is_followed(92.0, Told::kToPass, 2)) << "it goes straight on, too";
  EXPECT_TRUE(is_followed(92.0, Told::kToPass, path_, {{91.0, 93.0}})) << "it is on his lane";
  EXPECT_FALSE(is_followed(92.0, Told::kToPass, path_, {{94.0, 120.0}})) << "and here not yet";
}

}  // namespace
}  // namespace mvtp
