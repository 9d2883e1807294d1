#include "planner/motion/reference_path.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace mvtp {
namespace {

/// Straight on, then a corner of 90 degrees to the left, as SUMO draws the lanes of a junction.
const std::vector<Point> kCorner = {{0, 0}, {30, 0}, {30, 30}};

TEST(Smooth, LeavesAStraightLineWhereItIs) {
  for (const Point& p : smooth(std::vector<Point>{{0, 0}, {10, 0}, {25, 0}}, 2.5)) {
    EXPECT_NEAR(p.y, 0.0, 1e-12);
  }
}

TEST(Smooth, KeepsTheStraightEndsOfABentLine) {
  const auto line = smooth(kCorner, 2.5);
  EXPECT_NEAR(line.front().x, 0.0, 1e-9);
  EXPECT_NEAR(line.front().y, 0.0, 1e-9);
  EXPECT_NEAR(line.back().x, 30.0, 1e-9);
  EXPECT_NEAR(line.back().y, 30.0, 1e-9);
}

TEST(ReferencePath, AdvancesAsFarAsItsParameterSays) {
  const ReferencePath path(smooth(kCorner, 2.5));
  for (double s = 0.0; s + 0.1 < path.length(); s += 0.037) {
    EXPECT_NEAR(distance(path.at(s), path.at(s + 0.1)), 0.1, 1e-4) << "at s = " << s;
  }
}

TEST(ReferencePath, TurnsByTheIntegralOfItsCurvature) {
  const ReferencePath path(smooth(kCorner, 2.5));
  double turned = 0.0;
  for (double s = 0.0; s < path.length(); s += 0.01) turned += 0.01 * path.curvature(s);
  EXPECT_NEAR(turned, std::numbers::pi / 2, 0.01);
}

TEST(ReferencePath, HasTheHeadingOfItsMotion) {
  const ReferencePath path(smooth(kCorner, 2.5));
  for (double s = 1.0; s < path.length() - 1.0; s += 0.31) {
    const Pose a = path.at(s - 0.2);
    const Pose b = path.at(s + 0.2);
    EXPECT_NEAR(wrap_to_pi(std::atan2(b.y - a.y, b.x - a.x) - path.at(s).theta), 0.0, 0.02);
  }
}

TEST(ReferencePath, GoesOnStraightBeyondItsEnds) {
  const ReferencePath path(std::vector<Point>{{0, 0}, {10, 0}});
  EXPECT_EQ(path.at(-3.0), (Pose{-3, 0, 0}));
  EXPECT_NEAR(path.at(path.length() + 2.0).x, path.length() + 2.0, 1e-9);
}

TEST(ReferencePath, ProjectsItsOwnPointsOntoThemselves) {
  const ReferencePath path(smooth(kCorner, 2.5));
  for (double s = 0.0; s < path.length(); s += 0.7) {
    const Pose p = path.at(s);
    EXPECT_NEAR(path.project({p.x, p.y}, s - 3.0, s + 3.0), s, 0.01);
  }
}

}  // namespace
}  // namespace mvtp
