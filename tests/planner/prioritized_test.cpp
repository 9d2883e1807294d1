#include "planner/escot/prioritized.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "planner/problem/metrics.hpp"
#include "planner/problem/validate.hpp"
#include "tests/planner/scenes.hpp"

namespace mvtp {
namespace {

constexpr double kPi = std::numbers::pi;

PlannerResult plan_for(const Instance& instance, const PrioritizedOptions& options = {}) {
  const PlanningProblem problem(instance, CollisionRule::kContinuous);
  return plan_prioritized(problem, options, Deadline::never());
}

/// Plans and lets the referee judge.
PlannerResult judged(const Instance& instance, const PrioritizedOptions& options = {}) {
  PlannerResult result = plan_for(instance, options);
  EXPECT_EQ(result.status, Status::kSolved);
  Plan plan;
  for (const Agent& agent : instance.agents) plan.names.push_back(agent.name);
  plan.trajectories = result.trajectories;
  plan.statistics.dt = instance.dt;
  for (const Violation& v : find_violations(instance, plan, CollisionRule::kContinuous)) {
    ADD_FAILURE() << v.message;
  }
  return result;
}

//   Both paths cross at (25, 25), where the second robot has its goal, right on the first path.
TEST(Prioritized, ALaterRobotDoesNotParkWhereAnEarlierOneHasYetToPass) {
  Instance instance{.agents = {}, .map = empty_map(50), .dt = 1.0};
  instance.agents = {agent({5, 25, 0}, {45, 25, 0}, 0),
                     agent({25, 15, kPi / 2}, {25, 24, kPi / 2}, 1)};
  const PlannerResult plan = judged(instance);
  ASSERT_EQ(plan.trajectories.size(), 2U);
  EXPECT_EQ(arrival_step(plan.trajectories[0]), 40U);  // straight on
  EXPECT_GT(arrival_step(plan.trajectories[1]), 18U);  // 9 m to drive, but not before
}

//   A lane 3.2 m wide; robot 1 stands at its end, at its goal, and robot 0 comes through.
TEST(Prioritized, ALaterRobotLeavesItsGoalForAnEarlierOne) {
  Instance instance{.agents = {}, .map = empty_map(60), .dt = 1.0};
  instance.map.polygons = {{{20, 0}, {40, 0}, {40, 28.4}, {20, 28.4}},
                           {{20, 31.6}, {40, 31.6}, {40, 60}, {20, 60}}};
  instance.agents = {agent({5, 30, 0}, {50, 40, 1}, 0), agent({41, 30, 0}, {41, 30, 0}, 1)};
  (void)judged(instance);
}

//   Robot 0 goes 28 m round to a place in the middle of the lane, robot 1 comes through 30 m later.
TEST(Prioritized, NobodyDrivesThroughARobotThatHasParked) {
  Instance instance{.agents = {}, .map = empty_map(60), .dt = 1.0};
  instance.agents = {agent({30, 40, 0}, {44, 30, kPi}, 0), agent({5, 30, 0}, {57, 30, 0}, 1)};
  const PlannerResult plan = judged(instance);
  // The path of robot 1, which is planned first, is the longer one; robot 0 parks right on it.
  ASSERT_EQ(plan.trajectories.size(), 2U);
  EXPECT_EQ(arrival_step(plan.trajectories[1]), 52U);
  EXPECT_GT(arrival_step(plan.trajectories[0]), 38U);
}

TEST(Prioritized, SolvesCrossingsThatNeedEverybodysGoalToBeCrossed) {
  for (const int robots : {2, 4, 8}) (void)judged(circle(robots));
}

TEST(Prioritized, TriesOtherOrdersWhenARobotFindsNoPath) {
  const Instance instance = random_instance(3, 10, 4, 24);
  ASSERT_EQ(plan_for(instance, {.max_orders = 1}).status, Status::kExhausted)
      << "the first order does; the test needs another instance";
  (void)judged(instance);
}

//   The seed acts where an order comes back, here because searches are kept small.
TEST(Prioritized, ADifferentSeedTriesOtherOrders) {
  const Instance instance = random_instance(3, 10, 4, 24);
  PrioritizedOptions options{.max_expansions = 150, .max_orders = 300, .seed = 1};
  EXPECT_EQ(plan_for(instance, options).status, Status::kSolved);
  options.seed = 2;
  EXPECT_EQ(plan_for(instance, options).status, Status::kExhausted);
}

TEST(Prioritized, GivesUpAfterSoManyOrders) {
  Instance instance = circle(2);
  instance.map.polygons = {{{24.5, 0}, {25.5, 0}, {25.5, 50}, {24.5, 50}}};  // a wall between them
  const PlannerResult plan = plan_for(instance, {.max_expansions = 500, .max_orders = 5});
  EXPECT_EQ(plan.status, Status::kExhausted);
  EXPECT_TRUE(plan.trajectories.empty());
}

}  // namespace
}  // namespace mvtp
