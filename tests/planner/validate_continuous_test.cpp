// Overlaps between the steps, the border of the tolerance, and plans that do not say how they
// drive.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "planner/problem/validate.hpp"
#include "tests/planner/validate_scene.hpp"

namespace mvtp {
namespace {

using namespace validate_scene;  // NOLINT(google-build-using-namespace)
using testing::ElementsAre;
using testing::IsEmpty;

// ---- between the steps

//   Two cars swap places in one step: apart at both ends, through each other between.
Scene swap_scene() {
  Scene scene;
  scene.instance.agents = {{"a", kCar, {10, 10, 0}, {20, 10, 0}},
                           {"b", kCar, {20, 10, 0}, {10, 10, 0}}};
  for (Agent& agent : scene.instance.agents) agent.vehicle.max_speed = 10.0;
  scene.plan.names = {"a", "b"};
  scene.plan.trajectories = {Trajectory({{{10, 10, 0}}, {{20, 10, 0}, 10, 0}}),
                             Trajectory({{{20, 10, 0}}, {{10, 10, 0}, -10, 0}})};
  return scene;
}

TEST(Validate, OnlyTheContinuousRuleSeesAnOverlapBetweenTheSteps) {
  EXPECT_THAT(swap_scene().judge(CollisionRule::kSteps), IsEmpty());
  ASSERT_THAT(swap_scene().broken(), ElementsAre(Rule::kRobotOverlap));
  EXPECT_NEAR(swap_scene().judge()[0].step, 0.35, 0.001);  // 7 m of gap closed at 20 m per step
}

TEST(Validate, OnlyTheContinuousRuleSeesACircleJumpedOver) {
  Scene scene = swap_scene();
  scene.instance.agents.pop_back();
  scene.plan.names.pop_back();
  scene.plan.trajectories.pop_back();
  scene.instance.map.circles = {{16, 10.0, 0.8}};
  EXPECT_THAT(scene.judge(CollisionRule::kSteps), IsEmpty());
  EXPECT_THAT(scene.broken(), ElementsAre(Rule::kObstacleOverlap));
}

TEST(Validate, OnlyTheContinuousRuleSeesAThinWallJumpedOver) {
  Scene scene = swap_scene();
  scene.instance.agents.pop_back();
  scene.plan.names.pop_back();
  scene.plan.trajectories.pop_back();
  scene.instance.map.polygons = {{{16, 5}, {16.01, 5}, {16.01, 15}, {16, 15}}};
  EXPECT_THAT(scene.judge(CollisionRule::kSteps), IsEmpty());
  EXPECT_THAT(scene.broken(), ElementsAre(Rule::kObstacleOverlap));
}

//   The axle turns by half a circle of 2 m; the nose, 10 m ahead, sweeps over a pole on its way.
TEST(Validate, OnlyTheContinuousRuleSeesWhatTheNoseSweepsOver) {
  Scene scene;
  scene.add("a", {25, 25, 0}, {});
  scene.instance.agents[0].vehicle.front = 10.0;
  scene.instance.agents[0].vehicle.max_speed = 7.0;
  move(scene.plan.trajectories[0], 2 * kPi, 0.5);
  scene.instance.agents[0].goal = scene.plan.trajectories[0].waypoints().back().pose;
  EXPECT_THAT(scene.judge(), IsEmpty());
  scene.instance.map.circles = {{32.41, 30.61, 0.2}};  // 8 m ahead of the axle at 40 degrees
  EXPECT_THAT(scene.judge(CollisionRule::kSteps), IsEmpty());
  EXPECT_THAT(scene.broken(), ElementsAre(Rule::kObstacleOverlap));
}

//   A half circle bulges over the border although both of its ends are inside.
TEST(Validate, OnlyTheContinuousRuleSeesTheArcBulgeOverTheBorder) {
  Scene scene;
  scene.instance.map.bounds = Bounds::kAxle;
  scene.add("a", {48.5, 20, 0}, {{1, 0.5}});
  scene.instance.agents[0].vehicle.max_speed = 7.0;
  scene.plan.trajectories[0] = Trajectory(Pose{48.5, 20, 0});
  move(scene.plan.trajectories[0], 2 * kPi, 0.5);  // radius 2: reaches x = 50.5
  scene.instance.agents[0].goal = scene.plan.trajectories[0].waypoints().back().pose;
  EXPECT_THAT(scene.judge(CollisionRule::kSteps), IsEmpty());
  ASSERT_THAT(scene.broken(), ElementsAre(Rule::kBounds));
  EXPECT_NEAR(scene.judge()[0].amount, 0.5, 1e-2);
}

// ---- the border of the tolerance

class Touching : public testing::TestWithParam<double> {};

TEST_P(Touching, UpToAMillimetreIsFineForRobotsSideBySide) {
  Scene scene;
  scene.add("a", {10, 10, GetParam()}, {{1, 0}, {1, 0}});
  const auto shifted = [&](double gap) {
    Scene both = scene;
    both.add("b", compose({10, 10, GetParam()}, {0.3, 2.0 + gap, 0}), {{1, 0}, {1, 0}});
    return both.broken();
  };
  EXPECT_THAT(shifted(0.0), IsEmpty());
  EXPECT_THAT(shifted(-0.00098), IsEmpty());
  EXPECT_THAT(shifted(-0.00103), ElementsAre(Rule::kRobotOverlap));
}

TEST_P(Touching, UpToAMillimetreIsFineForRobotsThatMeet) {
  const auto meeting = [&](double gap) {
    Scene scene;
    const Pose start{25, 25, GetParam()};
    scene.add("a", start, {{1, 0}});
    scene.add("b", compose(start, {7.0 + gap, 0, kPi}), {{1, 0}});
    return scene.broken();
  };
  EXPECT_THAT(meeting(-0.00098), IsEmpty());
  EXPECT_THAT(meeting(-0.00103), ElementsAre(Rule::kRobotOverlap));
}

TEST_P(Touching, UpToAMillimetreIsFineForObstacles) {
  const Pose start{25, 25, GetParam()};
  const auto facing = [&](double gap) {
    Scene scene;
    scene.add("a", start, {{1, 0}});
    return std::pair(scene, compose(start, {3.5 + gap, 0.3, 0}));
  };
  const auto circle = [&](double gap) {
    auto [scene, ahead] = facing(gap);
    const Pose center = compose(ahead, {0.8, 0, 0});
    scene.instance.map.circles = {{center.x, center.y, 0.8}};
    return scene.broken();
  };
  const auto wall = [&](double gap) {
    auto [scene, ahead] = facing(gap);
    for (const Pose& corner : {Pose{0, -9, 0}, Pose{1, -9, 0}, Pose{1, 9, 0}, Pose{0, 9, 0}}) {
      if (scene.instance.map.polygons.empty()) scene.instance.map.polygons.emplace_back();
      const Pose p = compose(ahead, corner);
      scene.instance.map.polygons[0].push_back({p.x, p.y});
    }
    return scene.broken();
  };
  EXPECT_THAT(circle(-0.00098), IsEmpty());
  EXPECT_THAT(circle(-0.00103), ElementsAre(Rule::kObstacleOverlap));
  EXPECT_THAT(wall(-0.00098), IsEmpty());
  EXPECT_THAT(wall(-0.00103), ElementsAre(Rule::kObstacleOverlap));
}

INSTANTIATE_TEST_SUITE_P(Headings, Touching, testing::Values(0.0, 0.4, kPi / 2, 2.5, -2.0));

TEST(Validate, ATouchOfTheBorderUpToAMillimetreIsFine) {
  Scene scene;
  scene.add("a", {46.5009, 10, 0}, {{1, 0}});
  EXPECT_THAT(scene.judge(), IsEmpty());
  scene.instance.map.width = 49.9998;
  EXPECT_THAT(scene.broken(), ElementsAre(Rule::kBounds));
}

// ---- plans without v and phi

Scene without_controls(Scene scene, double digits = 0.0) {
  for (Trajectory& trajectory : scene.plan.trajectories) {
    std::vector<Waypoint> waypoints = trajectory.waypoints();
    for (std::size_t k = 0; k < waypoints.size(); ++k) {
      Waypoint& w = waypoints[k];
      if (k > 0) w.v = w.phi = kNaN;
      if (digits == 0.0) continue;
      for (const auto member : {&Pose::x, &Pose::y, &Pose::theta}) {
        w.pose.*member = std::round(w.pose.*member * digits) / digits;
      }
    }
    trajectory = Trajectory(waypoints);
  }
  return scene;
}

TEST(Validate, InfersTheArcsOfAPlanWithoutControls) {
  EXPECT_THAT(without_controls(good_scene()).judge(), IsEmpty());
  EXPECT_THAT(without_controls(good_scene(), 1e4).judge(), IsEmpty());
}

TEST(Validate, FollowsInferredArcsBetweenTheSteps) {
  const Scene scene = without_controls(swap_scene());
  EXPECT_THAT(scene.judge(CollisionRule::kSteps), IsEmpty());
  EXPECT_THAT(scene.broken(), ElementsAre(Rule::kRobotOverlap));
}

TEST(Validate, AppliesTheLimitsToInferredArcs) {
  Scene scene;
  scene.add("fast", {10, 10, 0}, {{1.1, 0}}).add("tight", {30, 30, 0}, {{1, 0.6}});
  EXPECT_THAT(without_controls(scene).broken(), ElementsAre(Rule::kCurvature, Rule::kSpeed));
}

TEST(Validate, TurningOnTheSpotIsNoMotionOfACar) {
  Scene scene;
  scene.add("a", {10, 10, 0}, {{0, 0}});
  scene.plan.trajectories[0] = Trajectory({{{10, 10, 0}}, {{10, 10, 0.5}, kNaN, kNaN}});
  scene.instance.agents[0].goal.theta = 0.5;
  EXPECT_FALSE(scene.judge().empty());
}

//   A sideways shift is no arc; it is followed on the straight line, and hits the circle there.
TEST(Validate, FollowsTheStraightLineWhereNoArcFits) {
  Scene scene;
  scene.add("a", {10, 10, 0}, {});
  scene.plan.trajectories[0] = Trajectory({{{10, 10, 0}}, {{10, 20, 0}, kNaN, kNaN}});
  scene.instance.agents[0].goal.y = 20.0;
  scene.instance.agents[0].vehicle.max_speed = 20.0;
  ASSERT_THAT(scene.broken(), ElementsAre(Rule::kArc));
  scene.instance.map.circles = {{11, 15, 0.8}};
  EXPECT_THAT(scene.broken(), ElementsAre(Rule::kArc, Rule::kObstacleOverlap));
}

}  // namespace
}  // namespace mvtp
