#include "planner/problem/validate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kPi = std::numbers::pi;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A box 3 x 2 m that turns on a circle of 2 m; the wheelbase of 1 m makes tan(phi) the curvature.
const Vehicle kCar{.front = 2.5,
                   .rear = 0.5,
                   .width = 2.0,
                   .wheelbase = 1.0,
                   .min_turning_radius = 2.0,
                   .max_speed = 1.0};

double phi_of(double curvature) { return std::atan(curvature * kCar.wheelbase); }

/// One step on: speed [m/s] and curvature [1/m] held for `dt`.
void move(Trajectory& trajectory, double v, double curvature, double dt = 1.0) {
  const Pose from = trajectory.waypoints().back().pose;
  trajectory.push_back({drive(from, v * dt, curvature), v, phi_of(curvature)});
}

struct Scene {
  Instance instance;
  Plan plan;

  explicit Scene(double width = 50.0, double height = 50.0) {
    instance.map.width = width;
    instance.map.height = height;
  }

  /// Adds a car that drives the (v, curvature) of each step, with the goal where it ends.
  Scene& add(const std::string& name, const Pose& start,
             const std::vector<std::pair<double, double>>& steps) {
    Trajectory trajectory(start);
    for (const auto& [v, curvature] : steps) move(trajectory, v, curvature, plan.statistics.dt);
    instance.agents.push_back({name, kCar, start, trajectory.waypoints().back().pose});
    plan.names.push_back(name);
    plan.trajectories.push_back(std::move(trajectory));
    return *this;
  }

  [[nodiscard]] std::vector<Violation> judge(
      CollisionRule rule = CollisionRule::kContinuous) const {
    return find_violations(instance, plan, rule);
  }

  [[nodiscard]] std::vector<Rule> broken(CollisionRule rule = CollisionRule::kContinuous) const {
    std::vector<Rule> rules;
    for (const Violation& violation : judge(rule)) rules.push_back(violation.rule);
    return rules;
  }
};

/// The same trajectory with its k-th waypoint changed.
template <class Change>
Trajectory changed(const Trajectory& trajectory, std::size_t k, const Change& change) {
  std::vector<Waypoint> waypoints = trajectory.waypoints();
  change(waypoints.at(k));
  return Trajectory(waypoints);
}

//   [0>  . . . . .        two cars, far apart, left and right turns, reverse and waits
//          <1]
Scene good_scene() {
  Scene scene;
  scene.add("a", {5, 5, 0}, {{1, 0}, {1, 0.5}, {1, -0.5}, {0, 0}, {-1, 0.5}, {0.3, 0.25}});
  scene.add("b", {30, 30, kPi}, {{1, 0.5}, {1, 0.5}, {1, 0.5}});
  return scene;
}

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

TEST(Validate, SteeringBeyondARightAngleIsNoWayAroundTheTurningCircle) {
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

// ---- laws

/// Three cars with random arcs in a narrow place; many such plans overlap, some barely.
Scene random_scene(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * double(random()) / double(std::mt19937::max());
  };
  Scene scene(16, 16);
  scene.instance.map.bounds = Bounds::kAxle;
  scene.instance.map.circles = {{uniform(0, 16), uniform(0, 16), 0.8}};
  scene.instance.map.polygons = {{{7, 0}, {9, 0}, {8, 2}}};
  for (const char* name : {"a", "b", "c"}) {
    std::vector<std::pair<double, double>> steps;
    for (int k = 0; k < 4; ++k) steps.emplace_back(uniform(-1, 1), uniform(-0.5, 0.5));
    scene.add(name, {uniform(2, 14), uniform(2, 14), uniform(-kPi, kPi)}, steps);
  }
  return scene;
}

std::array<Point, 4> corners(const Pose& pose) {
  std::array<Point, 4> result;
  const double half = 0.5 * kCar.width;
  const std::array<Point, 4> local = {
      {{kCar.front, half}, {-kCar.rear, half}, {-kCar.rear, -half}, {kCar.front, -half}}};
  for (std::size_t k = 0; k < 4; ++k) {
    const Pose p = compose(pose, {local[k].x, local[k].y, 0});
    result[k] = {p.x, p.y};
  }
  return result;
}

/// Depth of the overlap of two convex polygons from their corners alone: the least over all sides
/// of how far the other reaches behind the side. (Independent of the referee's half extents.)
template <class A, class B>
double depth(const A& a, const B& b) {
  const auto behind = [](const auto& p, const auto& q) {
    double least = std::numeric_limits<double>::infinity();
    double area = 0.0;
    for (std::size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) {
      area += p[j].x * p[i].y - p[i].x * p[j].y;
    }
    for (std::size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) {
      const double sign = area > 0 ? 1.0 : -1.0;
      const double nx = sign * (p[i].y - p[j].y);
      const double ny = -sign * (p[i].x - p[j].x);
      double farthest = -std::numeric_limits<double>::infinity();
      for (const Point& c : q) {
        farthest = std::max(farthest, -((c.x - p[i].x) * nx + (c.y - p[i].y) * ny));
      }
      least = std::min(least, farthest / std::hypot(nx, ny));
    }
    return least;
  };
  return std::min(behind(a, b), behind(b, a));
}

/// The deepest overlap of cars i and j at 2,000 moments per step.
double sampled_depth(const Plan& plan, std::size_t i, std::size_t j) {
  constexpr int kSamples = 2000;
  const auto at = [&](std::size_t car, std::size_t step, double s) {
    const Waypoint& w = plan.trajectories[car].at(step);
    return drive(plan.trajectories[car].at(step - 1).pose, s * w.v, std::tan(w.phi));
  };
  double deepest = -1e9;
  for (std::size_t step = 1; step <= 4; ++step) {
    for (int k = 0; k <= kSamples; ++k) {
      const double s = double(k) / kSamples;
      deepest = std::max(deepest, depth(corners(at(i, step, s)), corners(at(j, step, s))));
    }
  }
  return deepest;
}

TEST(ValidateLaws, AgreesWithDenseSampling) {
  int overlapping = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const Scene scene = random_scene(seed);
    const std::vector<Violation> violations = scene.judge();
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = i + 1; j < 3; ++j) {
        double found = 0.0;
        for (const Violation& v : violations) {
          if (v.rule == Rule::kRobotOverlap && v.agents[0] == scene.plan.names[i] &&
              v.agents[1] == scene.plan.names[j]) {
            found = std::max(found, v.amount);
          }
        }
        const double sampled = sampled_depth(scene.plan, i, j);
        overlapping += sampled > kTouchTolerance;
        // Two moments are 0.5 ms of a step apart: no point moves by more than 1.2 mm against
        // another.
        if (sampled > kTouchTolerance) {
          EXPECT_GT(found, kTouchTolerance) << "seed " << seed;
        }
        if (sampled < kTouchTolerance - 0.0025) {
          EXPECT_EQ(found, 0.0) << "seed " << seed;
        }
        if (found > 0.0) {
          EXPECT_NEAR(found, sampled, 0.05) << "seed " << seed;
        }
      }
    }
  }
  EXPECT_GT(overlapping, 30);
  EXPECT_LT(overlapping, 150);
}

Pose moved(const Pose& by, const Pose& pose) { return compose(by, pose); }

/// The scene without its map's border, shifted and turned.
Scene moved(const Pose& by, Scene scene) {
  for (Agent& agent : scene.instance.agents) {
    agent.start = moved(by, agent.start);
    agent.goal = moved(by, agent.goal);
  }
  for (Trajectory& trajectory : scene.plan.trajectories) {
    std::vector<Waypoint> waypoints = trajectory.waypoints();
    for (Waypoint& w : waypoints) w.pose = moved(by, w.pose);
    trajectory = Trajectory(waypoints);
  }
  for (Circle& c : scene.instance.map.circles) {
    const Pose p = moved(by, {c.x, c.y, 0});
    c = {p.x, p.y, c.radius};
  }
  for (Polygon& polygon : scene.instance.map.polygons) {
    for (Point& point : polygon) {
      const Pose p = moved(by, {point.x, point.y, 0});
      point = {p.x, p.y};
    }
  }
  return scene;
}

TEST(ValidateLaws, DoesNotDependOnWhereTheSceneLies) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    Scene scene = moved({500, 500, 0}, random_scene(seed));
    scene.instance.map.width = scene.instance.map.height = 1000;
    const std::vector<Violation> here = scene.judge();
    const std::vector<Violation> there = moved({500, 100, 0.7}, scene).judge();
    ASSERT_EQ(here.size(), there.size()) << "seed " << seed;
    for (std::size_t k = 0; k < here.size(); ++k) {
      EXPECT_EQ(here[k].rule, there[k].rule);
      EXPECT_EQ(here[k].agents, there[k].agents);
      EXPECT_NEAR(here[k].amount, there[k].amount, 1e-3);
    }
  }
}

TEST(ValidateLaws, DoesNotDependOnTheOrderOfTheAgents) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Scene scene = random_scene(seed);
    Scene reversed = scene;
    std::reverse(reversed.instance.agents.begin(), reversed.instance.agents.end());
    const auto sorted = [](const Scene& s) {
      std::vector<std::pair<Rule, std::vector<std::string>>> result;
      for (const Violation& v : s.judge()) {
        result.emplace_back(v.rule, v.agents);
        std::sort(result.back().second.begin(), result.back().second.end());
      }
      std::sort(result.begin(), result.end());
      return result;
    };
    EXPECT_EQ(sorted(scene), sorted(reversed)) << "seed " << seed;
  }
}

TEST(ValidateLaws, TheContinuousRuleIncludesTheStepsRule) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    const Scene scene = random_scene(seed);
    if (!scene.judge(CollisionRule::kSteps).empty()) {
      EXPECT_FALSE(scene.judge().empty()) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace mvtp
