#include "traci_bridge/sumo_frame.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace mvtp {
namespace {

constexpr double kPi = std::numbers::pi;

class SumoFrame : public testing::TestWithParam<double> {};

TEST_P(SumoFrame, RoundTripIsIdentity) {
  const SumoPosition p{12.0, -3.0, GetParam()};
  const SumoPosition q = to_sumo(from_sumo(p, 3.6), 3.6);
  EXPECT_NEAR(q.x_m, p.x_m, 1e-12);
  EXPECT_NEAR(q.y_m, p.y_m, 1e-12);
  EXPECT_NEAR(q.angle_deg, p.angle_deg, 1e-12);
}

TEST_P(SumoFrame, TheRearAxleIsBehindTheFrontBumper) {
  const SumoPosition p{12.0, -3.0, GetParam()};
  const Pose pose = from_sumo(p, 3.6);
  // SUMO's own compass: north is +y, east is +x.
  const double azimuth = GetParam() * kPi / 180.0;
  EXPECT_NEAR(p.x_m - pose.x, 3.6 * std::sin(azimuth), 1e-12);
  EXPECT_NEAR(p.y_m - pose.y, 3.6 * std::cos(azimuth), 1e-12);
}

TEST_P(SumoFrame, AClockwiseTurnLowersTheHeading) {
  const Pose before = from_sumo({0.0, 0.0, GetParam()}, 3.6);
  const Pose after = from_sumo({0.0, 0.0, GetParam() + 1.0}, 3.6);
  EXPECT_NEAR(wrap_to_pi(after.theta - before.theta), -kPi / 180.0, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(AllQuadrants, SumoFrame,
                         testing::Values(0., 1., 45., 89., 90., 91., 135., 180., 225., 269., 270.,
                                         271., 315., 359.));

TEST(SumoFrame, NorthEastSouthWest) {
  EXPECT_NEAR(from_sumo({0.0, 0.0, 0.0}, 1.0).theta, kPi / 2.0, 1e-15);
  EXPECT_NEAR(from_sumo({0.0, 0.0, 90.0}, 1.0).theta, 0.0, 1e-15);
  EXPECT_NEAR(from_sumo({0.0, 0.0, 180.0}, 1.0).theta, -kPi / 2.0, 1e-15);
  EXPECT_NEAR(std::abs(from_sumo({0.0, 0.0, 270.0}, 1.0).theta), kPi, 1e-15);
}

TEST(SumoFrame, AnglesStayBelow360Degrees) {
  for (const double theta :
       {kPi / 2.0, std::nextafter(kPi / 2.0, 4.0), kPi / 2.0 + 1e-15, kPi, -kPi, 3.0 * kPi}) {
    const double angle = to_sumo({0.0, 0.0, theta}, 3.6).angle_deg;
    EXPECT_GE(angle, 0.0) << theta;
    EXPECT_LT(angle, 360.0) << theta;
  }
}

TEST(BodyOf, CarsReachFourFifthsAheadOfTheRearAxle) {
  const Vehicle car = body_of(4.5, 1.8);
  EXPECT_DOUBLE_EQ(car.front, 3.6);
  EXPECT_DOUBLE_EQ(car.rear, 0.9);
  EXPECT_DOUBLE_EQ(car.width, 1.8);
  EXPECT_DOUBLE_EQ(car.wheelbase, 2.7);
  EXPECT_NEAR(car.min_turning_radius, 2.7 / std::tan(35.0 * kPi / 180.0), 1e-12);
}

TEST(BodyOf, LongVehiclesHaveALongerTail) {
  const Vehicle bus = body_of(12.0, 2.5);
  EXPECT_DOUBLE_EQ(bus.length(), 12.0);
  EXPECT_DOUBLE_EQ(bus.rear, 0.28 * 12.0);
  EXPECT_NEAR(bus.min_turning_radius, 6.0, 1e-12);
}

}  // namespace
}  // namespace mvtp
