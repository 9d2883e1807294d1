#include "planner/problem/pose.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace mvtp {
namespace {

constexpr double kPi = std::numbers::pi;

void expect_near(const Pose& a, const Pose& b, double tolerance = 1e-12) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(wrap_to_pi(a.theta - b.theta), 0.0, tolerance);
}

class PoseLaws : public testing::TestWithParam<double> {};

TEST_P(PoseLaws, RelativeUndoesCompose) {
  const Pose a{3.0, -2.0, GetParam()};
  const Pose b{-1.0, 0.5, 2.0};
  expect_near(relative(a, compose(a, b)), b);
  expect_near(compose(a, relative(a, b)), b);
}

TEST_P(PoseLaws, DrivingBackUndoesDriving) {
  const Pose start{1.0, 2.0, GetParam()};
  for (const double curvature : {0.0, 1e-9, 1e-3, 0.4, -0.4}) {
    expect_near(drive(drive(start, 1.7, curvature), -1.7, curvature), start, 1e-10);
  }
}

TEST_P(PoseLaws, TwoHalvesMakeOneArc) {
  const Pose start{0.0, 0.0, GetParam()};
  for (const double curvature : {0.0, 1e-5, 9e-5, 2e-4, 0.3}) {
    expect_near(drive(drive(start, 0.5, curvature), 0.5, curvature), drive(start, 1.0, curvature),
                1e-10);
  }
}

INSTANTIATE_TEST_SUITE_P(AllQuadrants, PoseLaws,
                         testing::Values(0.0, 0.7, kPi / 2, 2.5, kPi, -2.5, -kPi / 2, -0.1));

//   A quarter circle to the left of radius 2 ends 2 m ahead, 2 m to the left, facing left.
TEST(Drive, AQuarterCircleEndsWhereGeometrySays) {
  expect_near(drive({0, 0, 0}, kPi, 0.5), {2, 2, kPi / 2});
  expect_near(drive({0, 0, 0}, -kPi, 0.5), {-2, 2, -kPi / 2});
}

TEST(WrapToPi, KeepsPiAndMapsMinusPiToIt) {
  EXPECT_DOUBLE_EQ(wrap_to_pi(kPi), kPi);
  EXPECT_DOUBLE_EQ(wrap_to_pi(-kPi), kPi);
  EXPECT_NEAR(wrap_to_pi(7.0), 7.0 - 2 * kPi, 1e-12);
}

}  // namespace
}  // namespace mvtp
