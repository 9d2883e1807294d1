#include "planner/problem/plan_array.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace mvtp {
namespace {

Trajectory zigzag() {
  Trajectory trajectory(Pose{1.0, 2.0, 0.3});
  for (int t = 0; t < 7; ++t) {
    const Pose from = trajectory.waypoints().back().pose;
    const double v = t % 2 == 0 ? 1.0 : -0.5;
    trajectory.push_back({drive(from, v, 0.1 * t), v, std::atan(0.2 * t)});
  }
  return trajectory;
}

TEST(PlanArray, HasOneRowPerStepAndTheColumnsOfAWaypoint) {
  const Trajectory trajectory = zigzag();
  const auto array = states(trajectory);
  ASSERT_EQ(array.rows(), 8);
  for (Eigen::Index t = 0; t < array.rows(); ++t) {
    const Waypoint& w = trajectory.at(std::size_t(t));
    const StateArray row{{w.pose.x, w.pose.y, w.pose.theta, w.v, w.phi}};
    EXPECT_TRUE((array.row(t) == row.row(0)).all()) << t;
  }
}

TEST(PlanArray, IsAViewAndNoCopy) {
  const Trajectory trajectory = zigzag();
  EXPECT_EQ(states(trajectory).data(), &trajectory.waypoints().front().pose.x);
}

TEST(PlanArray, ComesBackAsTheSameTrajectory) {
  const Trajectory trajectory = zigzag();
  EXPECT_EQ(trajectory_of(states(trajectory)), trajectory);
  EXPECT_EQ(trajectory_of(states(trajectory).topRows(1)), Trajectory(Pose{1.0, 2.0, 0.3}));
}

TEST(PlanArray, KeepsWhatIsNotSaid) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Trajectory trajectory({{{0, 0, 0}, nan, nan}});
  const auto array = states(trajectory);
  EXPECT_TRUE(array.rightCols<2>().isNaN().all());
  EXPECT_TRUE(std::isnan(trajectory_of(array).at(0).v));
}

}  // namespace
}  // namespace mvtp
