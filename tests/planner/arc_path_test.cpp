#include "planner/motion/arc_path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace mvtp {
namespace {

void expect_equal(const Pose& a, const Pose& b) {
  EXPECT_NEAR(a.x, b.x, 1e-9);
  EXPECT_NEAR(a.y, b.y, 1e-9);
  EXPECT_NEAR(std::remainder(a.theta - b.theta, 2 * std::numbers::pi), 0.0, 1e-9);
}

//   Ahead in a left bend, straight on, back in a right bend, back straight on.
ArcPath there_and_back() {
  ArcPath path({1.0, 2.0, 0.5});
  path.append({{2.0, 0.25}, {1.5, 0.0}, {-1.0, -0.2}, {-0.5, 0.0}});
  return path;
}

TEST(ArcPath, DrivesItsArcsOneAfterTheOther) {
  const ArcPath path = there_and_back();
  EXPECT_DOUBLE_EQ(path.length(), 5.0);
  Pose pose{1.0, 2.0, 0.5};
  expect_equal(path.at(0.0), pose);
  pose = drive(pose, {2.0, 0.25});
  expect_equal(path.at(2.0), pose);
  pose = drive(pose, {1.5, 0.0});
  expect_equal(path.at(3.5), pose);
  pose = drive(pose, {-1.0, -0.2});
  expect_equal(path.at(4.5), pose);
  expect_equal(path.at(5.0), drive(pose, {-0.5, 0.0}));
}

TEST(ArcPath, NeverJumps) {
  const ArcPath path = there_and_back();
  for (double s = 0.0; s < path.length(); s += 0.01) {
    const Pose a = path.at(s);
    const Pose b = path.at(s + 0.01);
    EXPECT_LE(std::hypot(b.x - a.x, b.y - a.y), 0.01 + 1e-9) << s;
    EXPECT_LE(std::abs(b.theta - a.theta), 0.01 * 0.25 + 1e-9) << s;
  }
}

TEST(ArcPath, RollsStraightOnBeyondItsEnd) {
  const ArcPath path = there_and_back();
  expect_equal(path.at(6.0), drive(path.at(5.0), {-1.0, 0.0}));
}

TEST(ArcPath, KnowsWhereItTurnsRound) {
  const ArcPath path = there_and_back();
  EXPECT_EQ(path.reversals(), 1);
  EXPECT_DOUBLE_EQ(path.stop_after(0.0), 3.5);
  EXPECT_DOUBLE_EQ(path.stop_after(3.4), 3.5);
  EXPECT_DOUBLE_EQ(path.stop_after(3.5), 5.0);
  EXPECT_EQ(path.direction_from(3.4), 1);
  EXPECT_EQ(path.direction_from(3.5), -1);
}

TEST(ArcPath, WaitsAreLeftOutAndEqualNeighboursAreOne) {
  ArcPath path({0.0, 0.0, 0.0});
  path.append({{1.0, 0.1}, {0.0, 0.0}, {1.0, 0.1}});
  EXPECT_EQ(path.pieces().size(), 1u);
  EXPECT_DOUBLE_EQ(path.length(), 2.0);
}

TEST(ArcPath, TruncatedItIsTheSameSoFar) {
  for (const double s : {0.0, 0.7, 2.0, 3.5, 4.2, 5.0, 9.0}) {
    ArcPath path = there_and_back();
    path.truncate(s);
    EXPECT_NEAR(path.length(), std::min(s, 5.0), 1e-5) << s;
    for (double t = 0.0; t <= path.length(); t += 0.1) {
      expect_equal(path.at(t), there_and_back().at(t));
    }
  }
}

TEST(ArcPath, WithoutLengthItIsAPlace) {
  const ArcPath path({1.0, 2.0, 3.0});
  EXPECT_EQ(path.length(), 0.0);
  EXPECT_EQ(path.direction_from(0.0), 0);
  EXPECT_EQ(path.stop_after(0.0), 0.0);
  expect_equal(path.at(4.0), {1.0, 2.0, 3.0});
}

}  // namespace
}  // namespace mvtp
