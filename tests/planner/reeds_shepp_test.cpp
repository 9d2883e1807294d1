#include "planner/motion/reeds_shepp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "planner/search/reeds_shepp_planner.hpp"

namespace mvtp {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kTurningRadius = 2.375;

std::vector<std::pair<Pose, Pose>> random_pairs(int n) {
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> place(-20, 20);
  std::uniform_real_distribution<double> near(-3, 3);
  std::uniform_real_distribution<double> yaw(-kPi, kPi);
  std::vector<std::pair<Pose, Pose>> pairs;
  for (int k = 0; k < n; ++k) {
    auto& xy = k % 2 == 0 ? place : near;
    pairs.push_back({{xy(rng), xy(rng), yaw(rng)}, {xy(rng), xy(rng), yaw(rng)}});
  }
  return pairs;
}

TEST(ReedsShepp, PathsEndAtTheGoalAndAreAsLongAsTheySay) {
  const ReedsShepp curves;
  for (const auto& [from, to] : random_pairs(2000)) {
    const std::vector<Arc> path = curves.path(from, to, kTurningRadius);
    const Pose end = drive(from, path);
    EXPECT_LT(distance(end, to), 1e-9);
    EXPECT_LT(std::abs(wrap_to_pi(end.theta - to.theta)), 1e-9);
    double length = 0.0;
    for (const Arc& arc : path) {
      length += std::abs(arc.length);
      EXPECT_LE(std::abs(arc.curvature), 1.0 / kTurningRadius + 1e-12);
    }
    EXPECT_NEAR(length, curves.length(from, to, kTurningRadius), 1e-9);
    EXPECT_GE(length, distance(from, to) - 1e-9);
  }
}

//   Known by geometry: straight on, straight back, a quarter circle, and turning round on the spot,
//   which takes three arcs of pi/3 each (Reeds & Shepp 1990).
TEST(ReedsShepp, KnowsLengthsFromGeometry) {
  const ReedsShepp curves;
  EXPECT_NEAR(curves.length({0, 0, 0}, {7, 0, 0}, 2.0), 7.0, 1e-9);
  EXPECT_NEAR(curves.length({0, 0, 0}, {-7, 0, 0}, 2.0), 7.0, 1e-9);
  EXPECT_NEAR(curves.length({0, 0, 0}, {2, 2, kPi / 2}, 2.0), kPi, 1e-9);
  EXPECT_NEAR(curves.length({0, 0, 0}, {0, 0, kPi}, 1.0), kPi, 1e-9);
}

TEST(ReedsShepp, IsAsLongAsOmplsPath) {
  for (const auto& [from, to] : random_pairs(20000)) {
    const double ours = reeds_shepp_length(from, to, kTurningRadius);
    EXPECT_NEAR(ours, shortest_length(from, to, kTurningRadius), 1e-9)
        << from.x << ' ' << from.y << ' ' << from.theta << " to " << to.x << ' ' << to.y << ' '
        << to.theta;
  }
}

TEST(ReedsShepp, ThePathBackIsAsLong) {
  const ReedsShepp curves;
  for (const auto& [from, to] : random_pairs(500)) {
    EXPECT_NEAR(curves.length(from, to, kTurningRadius), curves.length(to, from, kTurningRadius),
                1e-9);
  }
}

TEST(ReedsShepp, APathToWhereItStartsIsEmpty) {
  EXPECT_TRUE(ReedsShepp().path({3, 4, 1}, {3, 4, 1}, kTurningRadius).empty());
}

TEST(ReedsSheppTable, IsCloseToTheCurves) {
  const ReedsShepp curves;
  const ReedsSheppTable table;
  double sum = 0.0;
  int n = 0;
  for (const auto& [from, to] : random_pairs(3000)) {
    const Pose d = relative(from, to);
    const double error = std::abs(table.length(d.x, d.y, d.theta) - curves.length({}, d, 1.0));
    EXPECT_LT(error, 0.4);
    sum += error;
    ++n;
  }
  EXPECT_LT(sum / n, 0.02);
}

}  // namespace
}  // namespace mvtp
