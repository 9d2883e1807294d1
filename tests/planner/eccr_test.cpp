#include "planner/algorithms/eccr.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "planner/algorithms/fleet.hpp"
#include "planner/search/conflict.hpp"
#include "tests/planner/scenes.hpp"

namespace mvtp {
namespace {

std::vector<EccrRobot> all_robots(const Fleet& fleet) {
  std::vector<EccrRobot> robots;
  const Configuration starts = fleet.starts();
  for (int i = 0; i < fleet.size(); ++i) {
    robots.push_back({&fleet.car(i), &fleet.cost_to_go(i), starts[std::size_t(i)]});
  }
  return robots;
}

/// Solves, and checks that nobody collides and everybody ends at its goal.
EccrResult solved(const Fleet& fleet, const EccrOptions& options = {}) {
  EccrResult result = solve_eccr(all_robots(fleet), {}, SpacetimeHybridAstar(fleet.curves()),
                                 options, Deadline::never());
  EXPECT_EQ(result.failure, EccrFailure::kNone);
  if (result.failure != EccrFailure::kNone) return result;
  std::vector<MovingObstacle> motions;
  for (int i = 0; i < fleet.size(); ++i) {
    Pose pose = fleet.starts()[std::size_t(i)];
    motions.emplace_back(fleet.car(i), pose, result.steps[std::size_t(i)]);
    for (const Arc& arc : result.steps[std::size_t(i)]) pose = fleet.after(i, pose, arc);
    EXPECT_EQ(pose, fleet.goal(i));
  }
  std::vector<const MovingObstacle*> pointers;
  for (const MovingObstacle& motion : motions) pointers.push_back(&motion);
  EXPECT_EQ(find_conflicts(pointers).count, 0);
  return result;
}

TEST(Eccr, LetsTwoRobotsPassEachOther) {
  const Instance instance = circle(2);
  const Fleet fleet(instance, CollisionRule::kContinuous);
  const EccrResult result = solved(fleet);
  for (const auto& steps : result.steps) EXPECT_LE(steps.size(), 40U);  // 30 straight
}

TEST(Eccr, SolvesFourOnACircle) {
  const Instance instance = circle(4);
  const Fleet fleet(instance, CollisionRule::kContinuous);
  (void)solved(fleet);
}

//   Robot 1 stands at its goal, right at the end of a lane 3.2 m wide that robot 0 comes through.
TEST(Eccr, MovesARobotOffItsGoalForAnother) {
  Instance instance{.agents = {}, .map = empty_map(60), .dt = 1.0};
  instance.map.polygons = {{{20, 0}, {40, 0}, {40, 28.4}, {20, 28.4}},
                           {{20, 31.6}, {40, 31.6}, {40, 60}, {20, 60}}};
  instance.agents = {agent({5, 30, 0}, {50, 40, 1}, 0), agent({41, 30, 0}, {41, 30, 0}, 1)};
  const Fleet fleet(instance, CollisionRule::kContinuous);
  const EccrResult result = solved(fleet, {.w = 1.5, .max_nodes = 3000, .max_expansions = 20000});
  ASSERT_EQ(result.steps.size(), 2U);
  EXPECT_GT(result.steps[1].size(), 2U);
}

TEST(Eccr, SaysSoWhenARobotHasNoWay) {
  Instance instance{.agents = {agent({10, 15, 0}, {20, 15, 0})}, .map = empty_map(30), .dt = 1.0};
  instance.map.polygons = {{{14.5, 0}, {15.5, 0}, {15.5, 30}, {14.5, 30}}};
  const Fleet fleet(instance, CollisionRule::kContinuous);
  EXPECT_EQ(
      solve_eccr(all_robots(fleet), {}, SpacetimeHybridAstar(fleet.curves()), {}, Deadline::never())
          .failure,
      EccrFailure::kNoPath);
}

TEST(Eccr, AvoidsRobotsOutsideTheGroupWhereThatIsCheap) {
  const Instance instance = circle(2);
  const Fleet fleet(instance, CollisionRule::kContinuous);
  // Robot 1 drives straight on; robot 0 is a group of its own.
  const MovingObstacle straight(fleet.car(1), fleet.starts()[1], std::vector<Arc>(30, Arc{1, 0}));
  const std::vector<const MovingObstacle*> others = {&straight};
  const std::vector<EccrRobot> group = {all_robots(fleet)[0]};
  const EccrResult result =
      solve_eccr(group, others, SpacetimeHybridAstar(fleet.curves()), {}, Deadline::never());
  ASSERT_EQ(result.failure, EccrFailure::kNone);
  const MovingObstacle own(fleet.car(0), fleet.starts()[0], result.steps[0]);
  EXPECT_FALSE(first_conflict(own, straight, 60));
}

}  // namespace
}  // namespace mvtp
