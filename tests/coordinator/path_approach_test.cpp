#include "coordinator/path_approach.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace mvtp {
namespace {

/// 40 m straight on, and then to the left on a circle of 30 m.
ReferencePath bent_path() {
  std::vector<Point> points = {{0, 0}, {40, 0}};
  for (int i = 1; i <= 90; ++i) {
    const double a = i * 0.0174533;
    points.push_back({40.0 + 30.0 * std::sin(a), 30.0 - 30.0 * std::cos(a)});
  }
  return ReferencePath(smooth(points, 2.0));
}

TEST(PathApproach, OnThePathTheGroundIsAsLongAsThePath) {
  const ReferencePath path = bent_path();
  EXPECT_LT(PathApproach(path, path.at(30.0), 30.0).ground_acceleration(path, 14.0), 0.1);
}

// Half a metre outside of the bend the wheels have more ground to cover, which begins within metres.
TEST(PathApproach, BesideABendTheGroundIsLonger) {
  const ReferencePath path = bent_path();
  const Pose beside = compose(path.at(36.0), {0.0, -1.0, 0.0});
  const PathApproach approach(path, beside, 36.0);
  EXPECT_GT(approach.ground_acceleration(path, 14.0), 0.4);
  // As the square of the speed.
  EXPECT_NEAR(approach.ground_acceleration(path, 7.0),
              approach.ground_acceleration(path, 14.0) / 4.0, 1e-9);
}

TEST(PathApproach, EndsOnThePathAndBeginsWhereTheVehicleIs) {
  const ReferencePath path = bent_path();
  const Pose beside = compose(path.at(20.0), {0.0, 0.6, 0.03});
  const PathApproach approach(path, beside, 20.0);
  EXPECT_NEAR(distance(approach.pose(path, approach.begin()), beside), 0.0, 1e-6);
  EXPECT_NEAR(distance(approach.pose(path, approach.begin() + 20.0),
                       path.at(approach.begin() + 20.0)),
              0.0, 1e-9);
  EXPECT_TRUE(approach.is_notable());
}

}  // namespace
}  // namespace mvtp
