#include "coordinator/corridor/path_approach.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

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
  const std::vector<double> limits(1, 14.0);
  EXPECT_GT(PathApproach(path, path.at(30.0), 30.0).acceleration_share(path, 14.0, 2.6, limits),
            0.95);
}

// Half a metre outside of the bend the wheels have more ground to cover, which begins within
// metres.
TEST(PathApproach, BesideABendTheGroundIsLonger) {
  const ReferencePath path = bent_path();
  const Pose beside = compose(path.at(36.0), {0.0, -1.0, 0.0});
  const PathApproach approach(path, beside, 36.0);
  const auto share = [&](double speed, double limit) {
    return approach.acceleration_share(path, speed, 2.6, std::vector<double>(1, limit));
  };
  EXPECT_LT(share(14.0, 14.0), 0.85);
  EXPECT_GT(share(7.0, 7.0), share(14.0, 14.0));
  // Who stands speeds up: what counts is how fast it may become on the way.
  EXPECT_LT(share(0.0, 14.0), share(0.0, 1.0) - 0.02);
}

// A profile with no more than the share of the acceleration never exceeds it over the ground.
TEST(PathApproach, TheShareHoldsOverTheGround) {
  constexpr double kDt = 0.1;
  constexpr double kAccel = 2.6;
  const ReferencePath path = bent_path();
  for (const double aside : {-1.2, -0.6, 0.3, 0.9}) {
    for (const double aslant : {-0.2, 0.0, 0.2}) {
      for (const double speed : {0.0, 3.0, 8.0}) {
        const PathApproach approach(path, compose(path.at(34.0), {0.0, aside, aslant}), 34.0);
        const std::vector<double> limits(1, 9.0);
        const double a = kAccel * approach.acceleration_share(path, speed, kAccel, limits);
        double s = approach.begin();
        double v = speed;
        double before = -1.0;
        for (int k = 0; k < 60 && a > 0.0; ++k) {
          const double next = std::min(v + a * kDt, limits[0]);
          const double driven = 0.5 * (v + next) * kDt;
          const double ground =
              distance(approach.pose(path, s), approach.pose(path, s + driven)) / kDt;
          if (before >= 0.0) {
            EXPECT_LT(std::abs(ground - before) / kDt, kAccel + 0.05)
                << aside << " " << aslant << " " << speed << " at " << s;
          }
          before = ground;
          s += driven;
          v = next;
        }
      }
    }
  }
}

TEST(PathApproach, EndsOnThePathAndBeginsWhereTheVehicleIs) {
  const ReferencePath path = bent_path();
  const Pose beside = compose(path.at(20.0), {0.0, 0.6, 0.03});
  const PathApproach approach(path, beside, 20.0);
  EXPECT_NEAR(distance(approach.pose(path, approach.begin()), beside), 0.0, 1e-6);
  EXPECT_NEAR(
      distance(approach.pose(path, approach.begin() + 20.0), path.at(approach.begin() + 20.0)), 0.0,
      1e-9);
  EXPECT_TRUE(approach.is_notable());
}

// However much room there is and however tightly the body turns.
TEST(PathApproach, WhoStandsAcrossItsPathDoesNotGetOntoIt) {
  Lane lane;
  lane.id = "E_0";
  lane.edge = "E";
  lane.width = 100.0;
  lane.shape = {{-100.0, 0.0}, {200.0, 0.0}};
  RoadNetwork network;
  network.lanes.emplace(lane.id, lane);
  const DrivableArea area(network);
  Vehicle body;
  body.min_turning_radius = 1.0;
  const ReferencePath path(std::vector<Point>{{0.0, 0.0}, {100.0, 0.0}});
  const auto is_drivable = [&](double askew) {
    const Pose pose{50.0, 0.4, askew};
    const PathApproach approach(path, pose, 50.0);
    if (std::abs(askew) < 1.5) {
      EXPECT_NEAR(approach.pose(path, approach.begin()).theta, askew, 1e-9);
    }
    return approach.is_drivable(path, body, area);
  };
  for (const double askew : {0.0, 0.2, 0.55}) EXPECT_TRUE(is_drivable(askew)) << askew;
  for (const double askew : {0.65, 0.9, 1.4, 1.6, 3.0}) EXPECT_FALSE(is_drivable(askew)) << askew;
  for (const double askew : {-0.65, -0.9, -1.4, -1.6, -3.0}) EXPECT_FALSE(is_drivable(askew));
}

}  // namespace
}  // namespace mvtp
