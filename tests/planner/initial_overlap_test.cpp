#include "planner/problem/initial_overlap.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planner/problem/check_instance.hpp"
#include "planner/problem/validate.hpp"
#include "planner/solve.hpp"
#include "tests/planner/scenes.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

//   A car of 3 x 2 m, 0.5 m of it behind the rear axle, drives 20 m straight ahead. Circles stand
//   beside its start and its goal, each 5 cm inside its side:
//
//        o                    o
//     [====>               [====>
Instance beside_two_circles() {
  Instance instance{.agents = {agent({10, 10, 0}, {30, 10, 0})}, .map = empty_map(40)};
  instance.map.circles = {{11, 11.75, 0.8}, {31, 11.75, 0.8}};
  instance.initial_overlap = InitialOverlap::kAllow;
  return instance;
}

/// Straight ahead from (10, y) to (30, y), a metre per step.
Plan straight_on(double y = 10.0) {
  Plan plan;
  plan.names = {"agent0"};
  Trajectory trajectory(Pose{10, y, 0});
  for (int t = 1; t <= 20; ++t) trajectory.push_back({{10.0 + t, y, 0}, 1.0, 0.0});
  plan.trajectories = {trajectory};
  return plan;
}

std::vector<std::string> messages(const Instance& instance, const Plan& plan) {
  std::vector<std::string> result;
  for (const Violation& violation : find_violations(instance, plan, CollisionRule::kContinuous)) {
    result.push_back(violation.message);
  }
  return result;
}

TEST(InitialOverlap, IsListedWithItsDepth) {
  const Instance instance = beside_two_circles();
  EXPECT_THAT(exemptions_of(instance), ElementsAre("start of agent0 in obstacles[0] by 0.05 m",
                                                   "goal of agent0 in obstacles[1] by 0.05 m"));
  EXPECT_THAT(check_instance(instance, "file"), IsEmpty());
  Instance strict = instance;
  strict.initial_overlap = InitialOverlap::kRefuse;
  EXPECT_THAT(exemptions_of(strict), IsEmpty());
  EXPECT_EQ(check_instance(strict, "file").size(), 2U);
}

TEST(InitialOverlap, WhatLeavesTheMapIsStillRefused) {
  Instance instance = beside_two_circles();
  instance.agents[0].start = {0.2, 10, 0};
  EXPECT_EQ(check_instance(instance, "file").size(), 1U);
}

TEST(InitialOverlap, IsExemptAtBothEnds) {
  Instance instance = beside_two_circles();
  EXPECT_THAT(messages(instance, straight_on()), IsEmpty());
  instance.initial_overlap = InitialOverlap::kRefuse;
  EXPECT_THAT(messages(instance, straight_on()),
              ElementsAre(HasSubstr("overlaps obstacles[0] by 0.0500 m"),
                          HasSubstr("overlaps obstacles[1] by 0.0500 m")));
}

//   1 m behind the circle at the start, the car comes back to it.
TEST(InitialOverlap, WhoIsApartMayNotComeBack) {
  const Instance instance = beside_two_circles();
  Plan plan;
  plan.names = {"agent0"};
  Trajectory trajectory(Pose{10, 10, 0});
  for (const double x : {11.0, 12.0, 13.0, 14.0, 13.0, 12.0, 11.0}) {
    trajectory.push_back({{x, 10, 0}, x < trajectory.waypoints().back().pose.x ? -1.0 : 1.0, 0.0});
  }
  while (trajectory.waypoints().back().pose.x < 30) {
    trajectory.push_back({{trajectory.waypoints().back().pose.x + 1, 10, 0}, 1.0, 0.0});
  }
  plan.trajectories = {trajectory};
  EXPECT_THAT(messages(instance, plan), ElementsAre(HasSubstr("overlaps obstacles[0]")));
}

//   Before its arrival, the car comes to its goal and leaves it again.
TEST(InitialOverlap, TheGoalIsExemptFromTheLastApproachOnOnly) {
  const Instance instance = beside_two_circles();
  Plan plan = straight_on();
  Trajectory& trajectory = plan.trajectories[0];
  for (const double x : {29.0, 28.0, 27.0, 26.0}) trajectory.push_back({{x, 10, 0}, -1.0, 0.0});
  for (const double x : {27.0, 28.0, 29.0, 30.0}) trajectory.push_back({{x, 10, 0}, 1.0, 0.0});
  EXPECT_THAT(messages(instance, plan), ElementsAre(HasSubstr("overlaps obstacles[1]")));
}

//   A step to the left first brings the body deeper into the circle beside it.
TEST(InitialOverlap, NobodyMayGetDeeper) {
  Instance instance = beside_two_circles();
  instance.map.circles.pop_back();
  Plan plan;
  plan.names = {"agent0"};
  Trajectory trajectory(Pose{10, 10, 0});
  const double curvature = 1.0 / instance.agents[0].vehicle.min_turning_radius;
  const Pose turned = drive(Pose{10, 10, 0}, 1.0, curvature);
  trajectory.push_back({turned, 1.0, std::atan(curvature * 2.0)});
  plan.trajectories = {trajectory};
  EXPECT_THAT(messages(instance, plan), testing::Contains(HasSubstr("overlaps obstacles[0]")));
}

TEST(InitialOverlap, TwoAgentsAreExemptUntilTheyAreApart) {
  Instance instance = beside_two_circles();
  instance.map.circles.clear();
  instance.agents.push_back(agent({10, 11.9, 0}, {10, 11.9, 0}, 1));
  Plan plan = straight_on();
  plan.names.push_back("agent1");
  plan.trajectories.emplace_back(Pose{10, 11.9, 0});
  EXPECT_THAT(exemptions_of(instance), ElementsAre("start of agent1 in that of agent0 by 0.10 m"));
  EXPECT_THAT(messages(instance, plan), IsEmpty());
  Plan back = plan;
  for (int t = 19; t >= 0; --t) back.trajectories[0].push_back({{10.0 + t, 10, 0}, -1.0, 0.0});
  instance.agents[0].goal = {10, 10, 0};  // where it overlaps again, and may
  EXPECT_THAT(messages(instance, back), IsEmpty());
  instance.agents[1].goal = {14, 11.9, 0};
  EXPECT_THAT(messages(instance, back), testing::Contains(HasSubstr("agent0 and agent1: overlap")));
}

/// Every algorithm on instances with a start and a goal inside an obstacle.
class AlgorithmsInObstacles : public testing::TestWithParam<std::string> {
 protected:
  static void expect_solved(const Instance& instance) {
    const Plan plan = solve(instance, {.algorithm = GetParam(), .gap = 1.0}, Deadline::in(60));
    EXPECT_EQ(plan.statistics.status, "solved") << plan.statistics.reason;
    EXPECT_THAT(messages(instance, plan), IsEmpty());
    EXPECT_EQ(plan.statistics.initial_overlaps, exemptions_of(instance));
  }
};

TEST_P(AlgorithmsInObstacles, GetOutOfCirclesAndIntoThem) { expect_solved(beside_two_circles()); }

TEST_P(AlgorithmsInObstacles, GetOutOfPolygonsAndIntoThem) {
  Instance instance = beside_two_circles();
  instance.map.circles.clear();
  instance.map.polygons = {{{9, 10.95}, {13, 10.95}, {13, 12}, {9, 12}},
                           {{29, 10.95}, {33, 10.95}, {31, 14}}};
  expect_solved(instance);
}

TEST_P(AlgorithmsInObstacles, PassEachOtherEvenSo) {
  Instance instance = beside_two_circles();
  instance.agents.push_back(agent({34, 10.5, 3.14159265}, {6, 10.5, 3.14159265}, 1));
  expect_solved(instance);
}

TEST_P(AlgorithmsInObstacles, RefuseThemUnlessAllowed) {
  Instance instance = beside_two_circles();
  instance.initial_overlap = InitialOverlap::kRefuse;
  const Plan plan = solve(instance, {.algorithm = GetParam()}, Deadline::in(60));
  EXPECT_EQ(plan.statistics.status, "infeasible");
}

INSTANTIATE_TEST_SUITE_P(Names, AlgorithmsInObstacles, testing::ValuesIn(algorithm_names()),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::erase(name, '-');
                           return name;
                         });

//   Side by side at the start, 10 cm of one in the other.
TEST(InitialOverlap, EscotAndPbcrLetTwoRobotsDriveApart) {
  Instance instance{
      .agents = {agent({10, 10, 0}, {30, 10, 0}, 0), agent({10, 11.9, 0}, {30, 15, 0}, 1),
                 agent({38, 10, 3.14}, {8, 10, 3.14}, 2)},
      .map = empty_map(50),
      .initial_overlap = InitialOverlap::kAllow};
  for (const std::string algorithm : {"escot", "pbcr"}) {
    const Plan plan = solve(instance, {.algorithm = algorithm}, Deadline::in(60));
    EXPECT_EQ(plan.statistics.status, "solved") << plan.statistics.reason;
    EXPECT_THAT(messages(instance, plan), IsEmpty());
  }
  const Plan other = solve(instance, {.algorithm = "eccr"}, Deadline::in(60));
  EXPECT_EQ(other.statistics.reason,
            "the starts of agent0 and agent1 overlap; only escot and pbcr let them");
}

}  // namespace
}  // namespace mvtp
