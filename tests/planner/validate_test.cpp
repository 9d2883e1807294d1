#include "planner/problem/validate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/planner/validate_scene.hpp"

namespace mvtp {
namespace {

using namespace validate_scene;  // NOLINT(google-build-using-namespace)
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TEST(Validate, FindsNothingInAGoodPlan) {
  EXPECT_THAT(good_scene().judge(), IsEmpty());
  EXPECT_THAT(good_scene().judge(CollisionRule::kSteps), IsEmpty());
}

TEST(Validate, AcceptsPlansInAnyOrderOfTheAgents) {
  Scene scene = good_scene();
  std::swap(scene.plan.names[0], scene.plan.names[1]);
  std::swap(scene.plan.trajectories[0], scene.plan.trajectories[1]);
  EXPECT_THAT(scene.judge(), IsEmpty());
}

// ---- one broken plan per rule

TEST(Validate, AnAgentWithoutATrajectoryIsMissing) {
  Scene scene = good_scene();
  scene.plan.names.pop_back();
  scene.plan.trajectories.pop_back();
  ASSERT_THAT(scene.broken(), ElementsAre(Rule::kAgentMissing));
  EXPECT_EQ(scene.judge()[0].message, "b: has no trajectory");
}

TEST(Validate, ATrajectoryOfNobodyIsUnknown) {
  Scene scene = good_scene();
  scene.plan.names.push_back("ghost");
  scene.plan.trajectories.emplace_back(Pose{1, 1, 0});
  ASSERT_THAT(scene.broken(), ElementsAre(Rule::kAgentUnknown));
  EXPECT_THAT(scene.judge()[0].agents, ElementsAre("ghost"));
}

TEST(Validate, ASecondTrajectoryOfAnAgentIsUnknown) {
  Scene scene = good_scene();
  scene.plan.names.push_back("a");
  scene.plan.trajectories.push_back(scene.plan.trajectories[0]);
  EXPECT_THAT(scene.broken(), ElementsAre(Rule::kAgentUnknown));
}

class NotFinite : public testing::TestWithParam<double> {};
TEST_P(NotFinite, IsReportedForEveryCoordinate) {
  for (const auto member : {&Pose::x, &Pose::y, &Pose::theta}) {
    Scene scene = good_scene();
    scene.plan.trajectories[1] =
        changed(scene.plan.trajectories[1], 2, [&](Waypoint& w) { w.pose.*member = GetParam(); });
    ASSERT_THAT(scene.broken(), ElementsAre(Rule::kNotFinite));
    EXPECT_EQ(scene.judge()[0].step, 2.0);
  }
}
INSTANTIATE_TEST_SUITE_P(Values, NotFinite,
                         testing::Values(kNaN, std::numeric_limits<double>::infinity(),
                                         -std::numeric_limits<double>::infinity()));

TEST(Validate, APoseBeyondAllMapsIsNotFinite) {
  Scene scene = good_scene();
  scene.plan.trajectories[1] =
      changed(scene.plan.trajectories[1], 2, [](Waypoint& w) { w.pose.x = 1e300; });
  EXPECT_THAT(scene.broken(), ElementsAre(Rule::kNotFinite));
}

TEST(Validate, ThePlanBeginsAtTheStart) {
  Scene scene = good_scene();
  scene.instance.agents[0].start.y += 0.01;
  ASSERT_THAT(scene.broken(), ElementsAre(Rule::kStart));
  EXPECT_NEAR(scene.judge()[0].amount, 0.01, 1e-9);
  scene.instance.agents[0].start.y -= 0.01;
  scene.instance.agents[0].start.theta += 0.01;
  EXPECT_THAT(scene.broken(), ElementsAre(Rule::kStart));
}

TEST(Validate, ThePlanEndsWithinATenthOfTheGoal) {
  Scene scene = good_scene();
  const Pose end = scene.instance.agents[0].goal;
  scene.instance.agents[0].goal = {end.x + 0.06, end.y - 0.07, end.theta + 0.09};
  EXPECT_THAT(scene.judge(), IsEmpty());
  scene.instance.agents[0].goal = {end.x + 0.08, end.y - 0.07, end.theta};
  EXPECT_THAT(scene.broken(), ElementsAre(Rule::kGoal));
  scene.instance.agents[0].goal = {end.x, end.y, end.theta + 0.11};
  EXPECT_THAT(scene.broken(), ElementsAre(Rule::kGoal));
}

TEST(Validate, HeadingsAreComparedAroundTheCircle) {
  Scene scene;
  scene.add("a", {10, 10, kPi - 0.01}, {{1, 0}});
  scene.instance.agents[0].goal.theta = -kPi + 0.01;
  scene.instance.agents[0].start.theta += 2 * kPi;
  EXPECT_THAT(scene.judge(), IsEmpty());
}

TEST(Validate, AStepFollowsTheArcOfItsSpeedAndSteering) {
  for (const auto& change : std::vector<void (*)(Waypoint&)>{
           [](Waypoint& w) { w.phi = 0.1; }, [](Waypoint& w) { w.v = 0.5; },
           [](Waypoint& w) { w.v = -w.v; }, [](Waypoint& w) { w.phi = -w.phi; }}) {
    Scene scene = good_scene();
    scene.plan.trajectories[0] = changed(scene.plan.trajectories[0], 2, change);
    ASSERT_THAT(scene.broken(), ElementsAre(Rule::kArc));
    EXPECT_EQ(scene.judge()[0].step, 2.0);
  }
}

TEST(Validate, AJumpIsNoArc) {
  Scene scene;
  scene.add("a", {10, 10, 0}, {{1, 0}, {1, 0}});
  scene.plan.trajectories[0] =
      changed(scene.plan.trajectories[0], 1, [](Waypoint& w) { w.pose.y += 0.05; });
  const std::vector<Violation> violations = scene.judge();
  ASSERT_THAT(violations, SizeIs(1));  // both steps, in a row
  EXPECT_EQ(violations[0].rule, Rule::kArc);
  EXPECT_NEAR(violations[0].amount, 0.05, 1e-9);
}

TEST(Validate, NoArcIsTighterThanTheTurningCircle) {
  Scene scene;
  scene.add("a", {10, 10, 0}, {{1, 0.5}, {1, 0.5 * (1 + 1e-7)}});
  EXPECT_THAT(scene.judge(), IsEmpty());
  scene.add("b", {30, 30, 0}, {{1, 0.51}});
  ASSERT_THAT(scene.broken(), ElementsAre(Rule::kCurvature));
  EXPECT_NEAR(scene.judge()[0].amount, 0.51, 1e-9);
  EXPECT_THAT(scene.judge()[0].message, HasSubstr("radius of 1.9608 m; at least 2.0000 m"));
}

TEST(Validate, SteeringBeyondARightAngleDoesNotEvadeTheTurningCircle) {
  Scene scene;
  scene.add("a", {10, 10, 0}, {{1, 0.2}});
  scene.plan.trajectories[0] =
      changed(scene.plan.trajectories[0], 1, [](Waypoint& w) { w.phi += kPi; });
  EXPECT_THAT(scene.broken(), ElementsAre(Rule::kCurvature));
}

TEST(Validate, NoStepIsFasterThanTheVehicle) {
  Scene scene;
  scene.add("a", {10, 10, 0}, {{1, 0}, {-1, 0}});
  EXPECT_THAT(scene.judge(), IsEmpty());
  scene.add("b", {30, 30, 0}, {{1, 0}, {-1.001, 0}});
  ASSERT_THAT(scene.broken(), ElementsAre(Rule::kSpeed));
  EXPECT_NEAR(scene.judge()[0].amount, 1.001, 1e-9);
}

TEST(Validate, TheStepDurationIsThatOfThePlan) {
  Scene scene;
  scene.plan.statistics.dt = 2.0;
  scene.add("a", {10, 10, 0}, {{1, 0}, {-1, 0.5}});
  EXPECT_THAT(scene.judge(), IsEmpty());
  scene.plan.statistics.dt = 1.0;
  EXPECT_THAT(scene.broken(), ElementsAre(Rule::kArc));
}

//   a stands; b drives at it from the left and overlaps it by the last 0.2 m
TEST(Validate, FootprintsOfRobotsDoNotOverlap) {
  Scene scene;
  scene.add("a", {20, 10, 0}, {});
  scene.add("b", {15.7, 10, 0}, {{1, 0}, {0.5, 0}, {0, 0}});
  const std::vector<Violation> violations = scene.judge();
  ASSERT_THAT(violations, SizeIs(1));
  EXPECT_EQ(violations[0].rule, Rule::kRobotOverlap);
  EXPECT_THAT(violations[0].agents, ElementsAre("a", "b"));
  EXPECT_NEAR(violations[0].amount, 0.2, 1e-3);
  EXPECT_NEAR(violations[0].step, 1.6, 0.01);  // 1.301 m of gap, at 0.5 m/s in the second step
  EXPECT_THAT(violations[0].message, HasSubstr("a and b: overlap by 0.2000 m from step 1.6"));
  EXPECT_THAT(scene.broken(CollisionRule::kSteps), ElementsAre(Rule::kRobotOverlap));
}

TEST(Validate, ARobotThatHasArrivedIsStillThere) {
  Scene scene;
  scene.add("early", {16, 10, 0}, {{1, 0}});
  scene.add("late", {10, 10, 0}, {{1, 0}, {1, 0}, {1, 0}, {1, 0}, {1, 0}});
  const std::vector<Violation> violations = scene.judge();
  ASSERT_THAT(violations, SizeIs(1));
  EXPECT_EQ(violations[0].rule, Rule::kRobotOverlap);
  EXPECT_NEAR(violations[0].step, 4.0, 0.01);
}

TEST(Validate, StartsThatOverlapAreFoundEvenIfNobodyMoves) {
  Scene scene;
  scene.add("a", {10, 10, 0}, {});
  scene.add("b", {10, 11.9, 0}, {});
  for (const CollisionRule rule : {CollisionRule::kContinuous, CollisionRule::kSteps}) {
    EXPECT_THAT(scene.broken(rule), ElementsAre(Rule::kRobotOverlap));
  }
}

TEST(Validate, AnOverlapThatLastsIsOneViolation) {
  Scene scene;
  scene.add("a", {10, 10, 0}, {{1, 0}, {0, 0}, {0, 0}, {-1, 0}, {0.1, 0}});
  scene.add("b", {11, 11, 0}, {{1, 0}, {0, 0}, {0, 0}, {-1, 0}, {-0.1, 0}});
  EXPECT_THAT(scene.broken(), ElementsAre(Rule::kRobotOverlap));
}

TEST(Validate, FootprintsDoNotOverlapCircles) {
  Scene scene;
  scene.add("a", {10, 10, 0}, {{1, 0}, {1, 0}});
  scene.instance.map.circles = {{40, 40, 5.0}, {15.0, 10.5, 0.8}};  // front ends at 14.5
  const std::vector<Violation> violations = scene.judge();
  ASSERT_THAT(violations, SizeIs(1));
  EXPECT_EQ(violations[0].rule, Rule::kObstacleOverlap);
  EXPECT_NEAR(violations[0].amount, 0.3, 1e-9);
  EXPECT_THAT(violations[0].message, HasSubstr("a: overlaps obstacles[1] by 0.3000 m at step 1.7"));
}

//   an L-shaped wall; the car drives into its inner corner
TEST(Validate, FootprintsDoNotOverlapPolygons) {
  Scene scene;
  scene.instance.map.polygons = {{{14, 5}, {20, 5}, {20, 15}, {8, 15}, {8, 12}, {14, 12}}};
  scene.add("a", {10, 10, 0}, {{1, 0}});
  EXPECT_THAT(scene.judge(), IsEmpty());  // front at 13.5
  move(scene.plan.trajectories[0], 1, 0);
  const std::vector<Violation> violations = scene.judge();
  ASSERT_FALSE(violations.empty());
  EXPECT_EQ(violations.back().rule, Rule::kObstacleOverlap);
  EXPECT_NEAR(violations.back().amount, 0.5, 1e-9);
  EXPECT_THAT(violations.back().message, HasSubstr("polygons[0]"));
}

TEST(Validate, AFootprintInsideALargePolygonOverlapsIt) {
  for (const double turn : {1.0, -1.0}) {  // either orientation of the outline
    Scene scene(100, 100);
    scene.instance.map.polygons = {
        {{10, 50 - 40 * turn}, {90, 50 - 40 * turn}, {90, 50 + 40 * turn}, {10, 50 + 40 * turn}}};
    scene.add("a", {50, 50, 0}, {{1, 0}});
    ASSERT_THAT(scene.broken(), ElementsAre(Rule::kObstacleOverlap));
    EXPECT_GE(scene.judge()[0].amount, 1.0);
  }
}

TEST(Validate, ASpikeThinnerThanTheToleranceStillPierces) {
  Scene scene;
  scene.instance.map.polygons = {{{13, 10.3}, {30, 10.3002}, {30, 10.2998}}};
  scene.add("a", {10, 10, 0}, {{1, 0}});
  EXPECT_THAT(scene.broken(), ElementsAre(Rule::kObstacleOverlap));
}

TEST(Validate, TheFootprintStaysInsideTheMap) {
  Scene scene;
  scene.add("a", {46.4, 10, 0}, {{1, 0}});  // front from 48.9 to 49.9
  EXPECT_THAT(scene.judge(), IsEmpty());
  move(scene.plan.trajectories[0], 0.3, 0.0);
  scene.instance.agents[0].goal = scene.plan.trajectories[0].waypoints().back().pose;
  ASSERT_THAT(scene.broken(), ElementsAre(Rule::kBounds));
  EXPECT_NEAR(scene.judge()[0].amount, 0.2, 1e-9);
  scene.instance.map.bounds = Bounds::kAxle;
  EXPECT_THAT(scene.judge(), IsEmpty());
}

TEST(Validate, TheRearAxleStaysInsideTheMap) {
  Scene scene;
  scene.instance.map.bounds = Bounds::kAxle;
  scene.add("a", {0.1, 10, 0}, {{-0.3, 0}});
  ASSERT_THAT(scene.broken(), ElementsAre(Rule::kBounds));
  EXPECT_NEAR(scene.judge()[0].amount, 0.2, 1e-9);
}

TEST(Validate, StandingBeyondTheBorderIsOneViolationUntilTheCarIsBack) {
  Scene scene;
  scene.add("a", {47.4, 10, 0}, {{0.3, 0}, {0, 0}, {0, 0}, {0.1, 0}});
  EXPECT_THAT(scene.broken(), ElementsAre(Rule::kBounds));
}

}  // namespace
}  // namespace mvtp
