#include "planner/motion/inertial_car.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace mvtp {
namespace {

TEST(InertialCar, TwoHalfStepsMakeOneStep) {
  for (const double a : {2.6, 0.0, -2.0, -4.5}) {
    const InertialState whole = advance({10.0, 1.5}, a, 0.8);
    const InertialState halves = advance(advance({10.0, 1.5}, a, 0.4), a, 0.4);
    EXPECT_NEAR(whole.s, halves.s, 1e-12);
    EXPECT_NEAR(whole.v, halves.v, 1e-12);
  }
}

TEST(InertialCar, BrakingEndsAtTheStoppingDistance) {
  EXPECT_NEAR(braked_position({5.0, 9.0}, 4.5, 100.0), 5.0 + stopping_distance(9.0, 4.5), 1e-12);
  EXPECT_NEAR(advance({5.0, 9.0}, -4.5, 100.0).s, 5.0 + stopping_distance(9.0, 4.5), 1e-12);
}

// Speeds, decelerations and steps without a common measure: v - b h is anything but a round number.
TEST(InertialCar, ComesToRestAtExactlyZeroWhateverTheSpeed) {
  for (int i = 1; i <= 100'000; ++i) {
    const double v = 40.0 * i / 100'000.0;
    for (const double b : {0.7, 1.5, 3.0, 4.0, 4.5, 6.1, 9.0}) {
      ASSERT_EQ(advance({0.0, v}, -b, v / b).v, 0.0) << v << " m/s at " << b << " m/s^2";
      ASSERT_EQ(advance({0.0, v}, -b, braking_steps(v, b, 0.1) * 0.1).v, 0.0) << v << ", " << b;
      if (i % 50 != 0) continue;
      for (const double h : {0.05, 0.1, 0.2, 0.25, 0.3, 0.5, 1.0}) {
        const int steps = braking_steps(v, b, h);
        InertialState stepwise{0.0, v};
        for (int k = 0; k < steps; ++k) stepwise = advance(stepwise, -b, h);
        ASSERT_EQ(stepwise.v, 0.0) << v << " m/s at " << b << " m/s^2 in steps of " << h << " s";
        ASSERT_EQ(advance({0.0, v}, -b, steps * h).v, 0.0) << v << ", " << b << ", " << h;
        ASSERT_NEAR(stepwise.s, stopping_distance(v, b), 1e-6);
      }
    }
  }
}

TEST(InertialCar, TheNumberOfBrakingStepsIsBounded) {
  EXPECT_EQ(braking_steps(0.0, 4.5, 0.1), 0);
  EXPECT_EQ(braking_steps(4.5, 4.5, 0.1), 10);
  EXPECT_EQ(braking_steps(10.0, 1e-12, 0.1), kMostBrakingSteps);
}

TEST(SpeedEnvelope, LowerLimitsCanBeReachedWithTheBrakingGiven) {
  std::vector<double> limits(200, 14.0);
  limits[150] = 4.0;
  const SpeedEnvelope envelope(limits, 3.5);
  for (double s = 0.0; s < 37.0; s += 0.25) {
    const double v = envelope.at(s);
    const double next = envelope.at(s + 0.25);
    EXPECT_LE((v * v - next * next) / (2.0 * 0.25), 3.5 + 1e-9);
  }
  EXPECT_DOUBLE_EQ(envelope.at(37.5), 4.0);
}

}  // namespace
}  // namespace mvtp
