#include "coordinator/lot/lot_lookout.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <numbers>

namespace mvtp {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kHalfPi = std::numbers::pi / 2;
const Vehicle kCar{.front = 3.6, .rear = 0.9, .width = 1.8, .min_turning_radius = 4.0};

/// A car that drives 40 m straight to the east from x = 0; a footpath crosses at x = 10.
class LotLookoutAhead : public testing::Test {
 protected:
  void drive(double speed, bool with_footpath, double from = 0.0) {
    LotCar car;
    car.body = kCar;
    car.path = ArcPath(Pose{0, 0, 0});
    car.path.append({{40.0, 0.0}});
    car.cells = PathCells(car.path, kCar, 0.04);
    const std::array footpaths = {Footpath{{{10, -20}, {10, 20}}, 2.0}};
    if (with_footpath) car.cells.keep_clear(KeepClear(footpaths));
    car.s = from;
    car.v = speed;
    motion_.put(car);
  }

  [[nodiscard]] double stopping_point(const std::vector<Pedestrian>& people,
                                      double turn = kInfinity) const {
    return LotLookout::stopping_point(motion_, motion_.cars().front(), turn, {people, {}});
  }

  LotMotion motion_;
};

Pedestrian walker(double x, double y, double theta, double speed = 1.3) {
  return {.position = {x, y}, .theta = theta, .speed = speed, .radius = 0.3};
}

TEST_F(LotLookoutAhead, NobodyThere) {
  drive(2.0, true);
  EXPECT_EQ(stopping_point({}), kInfinity);
}

TEST_F(LotLookoutAhead, StopsBeforeSomebodyWhoStands) {
  drive(2.0, false);
  // The front stops 0.6 m + 0.3 m before the person, whose radius is 0.3 m.
  EXPECT_NEAR(stopping_point({walker(8, 0, 0, 0.0)}), 8 - 0.3 - 0.6 - 0.3 - kCar.front, 0.3);
}

TEST_F(LotLookoutAhead, LetsThoseBeAloneWhoWalkAway) {
  drive(2.0, false);
  EXPECT_EQ(stopping_point({walker(8, 4, kHalfPi)}), kInfinity);   // beside, away from its path
  EXPECT_EQ(stopping_point({walker(-6, 0, 0)}), kInfinity);        // behind
  EXPECT_LT(stopping_point({walker(8, 4, -kHalfPi)}), kInfinity);  // towards it
}

TEST_F(LotLookoutAhead, WaitsAtAFootpathForWhoComes) {
  drive(2.0, true);
  const double before = 10 - 1.0 - kCar.front;
  // Is there when the car would be, 2 to 6 s from now.
  EXPECT_NEAR(stopping_point({walker(10, 6, -kHalfPi)}), before - 0.3, 0.3);
  // Has passed by then, or comes long after.
  EXPECT_EQ(stopping_point({walker(10, 1, kHalfPi)}), kInfinity);
  EXPECT_EQ(stopping_point({walker(10, 19, -kHalfPi)}), kInfinity);
}

TEST_F(LotLookoutAhead, EntersAFootpathOnlyToLeaveItAgain) {
  drive(2.0, true);
  const Pedestrian far = walker(10, 19, -kHalfPi);
  EXPECT_EQ(stopping_point({far}, 14.0), kInfinity);
  // Another car lets it no further than onto the footpath: it would stand there.
  EXPECT_LT(stopping_point({far}, 8.0), 10 - 1.0 - kCar.front);
}

//   To stop where somebody walks into its side would be worse.
TEST_F(LotLookoutAhead, CrossesAtOnceWhatItCanNoLongerStopBefore) {
  drive(2.3, true, 4.0);  // comes to rest behind the footpath's beginning, at 10 - 1 - 3.6 m
  EXPECT_EQ(stopping_point({walker(10, 6.1, -kHalfPi)}), kInfinity);
}

TEST_F(LotLookoutAhead, StandsWhereNobodyWalksIntoIt) {
  for (const double from : {2.0, 4.0, 4.8}) {
    motion_ = LotMotion();
    drive(1.0, true, from);
    for (double y = 1.0; y < 12.0; y += 0.5) {
      const double place = stopping_point({walker(10, y, -kHalfPi)});
      // The body covers the walker's line from 10 - 3.6 to 10 + 0.9 m on.
      const bool on_the_line = place > 10 - 3.6 - 0.3 && place < 10 + 0.9 + 0.3;
      EXPECT_FALSE(on_the_line) << "from " << from << " m, somebody at " << y << " m: " << place;
    }
  }
}

TEST_F(LotLookoutAhead, StopsBehindThoseWithDriversOfTheirOwn) {
  drive(2.0, false);
  const std::array strangers = {StandingCar{{9, 0, 0}, kCar}};
  const double stopping_point =
      LotLookout::stopping_point(motion_, motion_.cars().front(), kInfinity, {{}, strangers});
  EXPECT_LT(stopping_point, 9 - kCar.rear - 0.5 - kCar.front);
  EXPECT_GT(stopping_point, 9 - kCar.rear - 0.5 - kCar.front - 0.6);
}

}  // namespace
}  // namespace mvtp
