#include "planner/escot/conflict_based_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "planner/escot/planning_problem.hpp"
#include "planner/search/conflict.hpp"
#include "tests/planner/scenes.hpp"

namespace mvtp {
namespace {

std::vector<CbsRobot> all_robots(const PlanningProblem& problem) {
  std::vector<CbsRobot> robots;
  const Configuration starts = problem.starts();
  for (int i = 0; i < problem.size(); ++i) {
    robots.push_back({&problem.car(i), &problem.cost_to_go(i), starts[std::size_t(i)]});
  }
  return robots;
}

/// Solves, and checks that nobody collides and everybody ends at its goal.
CbsResult solved(const PlanningProblem& problem, const CbsOptions& options) {
  CbsResult result = conflict_based_search(
      all_robots(problem), {}, SpacetimeHybridAstar(problem.curves()), options, Deadline::never());
  EXPECT_EQ(result.failure, CbsFailure::kNone);
  if (result.failure != CbsFailure::kNone) return result;
  std::vector<SweptTrajectory> motions;
  for (int i = 0; i < problem.size(); ++i) {
    Pose pose = problem.starts()[std::size_t(i)];
    motions.emplace_back(problem.car(i), pose, result.steps[std::size_t(i)]);
    for (const Arc& arc : result.steps[std::size_t(i)]) pose = problem.after(i, pose, arc);
    EXPECT_EQ(pose, problem.goal(i));
  }
  EXPECT_TRUE(find_conflicts(motions).empty());
  return result;
}

std::size_t sum_of_steps(const CbsResult& result) {
  std::size_t sum = 0;
  for (const auto& steps : result.steps) sum += steps.size();
  return sum;
}

const CbsOptions kEccr = eccr_options();
const CbsOptions kClCbs = cl_cbs_options();

class Cbs : public testing::TestWithParam<CbsOptions> {};

TEST_P(Cbs, LetsTwoRobotsPassEachOther) {
  const Instance instance = circle(2);
  const PlanningProblem problem(instance, CollisionRule::kContinuous);
  const CbsResult result = solved(problem, GetParam());
  for (const auto& steps : result.steps) EXPECT_LE(steps.size(), 40U);  // 30 straight
}

TEST_P(Cbs, SolvesFourOnACircle) {
  const Instance instance = circle(4);
  const PlanningProblem problem(instance, CollisionRule::kContinuous);
  (void)solved(problem, GetParam());
}

//   Robot 1 stands at its goal, right at the end of a lane 3.2 m wide that robot 0 comes through.
TEST(Eccr, MovesARobotOffItsGoalForAnother) {
  Instance instance{.agents = {}, .map = empty_map(60), .dt = 1.0};
  instance.map.polygons = {{{20, 0}, {40, 0}, {40, 28.4}, {20, 28.4}},
                           {{20, 31.6}, {40, 31.6}, {40, 60}, {20, 60}}};
  instance.agents = {agent({5, 30, 0}, {50, 40, 1}, 0), agent({41, 30, 0}, {41, 30, 0}, 1)};
  const PlanningProblem problem(instance, CollisionRule::kContinuous);
  const CbsResult result = solved(problem, kEccr);
  ASSERT_EQ(result.steps.size(), 2U);
  EXPECT_GT(result.steps[1].size(), 2U);
}

TEST_P(Cbs, SaysSoWhenARobotHasNoPath) {
  Instance instance{.agents = {agent({10, 15, 0}, {20, 15, 0})}, .map = empty_map(30), .dt = 1.0};
  instance.map.polygons = {{{14.5, 0}, {15.5, 0}, {15.5, 30}, {14.5, 30}}};
  const PlanningProblem problem(instance, CollisionRule::kContinuous);
  EXPECT_EQ(conflict_based_search(all_robots(problem), {}, SpacetimeHybridAstar(problem.curves()),
                                  GetParam(), Deadline::never())
                .failure,
            CbsFailure::kNoPath);
}

TEST_P(Cbs, SaysSoWhenTimeIsUp) {
  const Instance instance = circle(4);
  const PlanningProblem problem(instance, CollisionRule::kContinuous);
  EXPECT_EQ(conflict_based_search(all_robots(problem), {}, SpacetimeHybridAstar(problem.curves()),
                                  GetParam(), Deadline::in(0))
                .failure,
            CbsFailure::kTimeout);
}

INSTANTIATE_TEST_SUITE_P(Configurations, Cbs, testing::Values(kClCbs, kEccr),
                         [](const auto& test) { return test.param.w == 1.0 ? "ClCbs" : "Eccr"; });

TEST(ClCbs, IsNoCostlierThanFocalSearch) {
  std::size_t optimal = 0;
  std::size_t focal = 0;
  for (std::uint64_t seed = 300; seed < 310; ++seed) {
    SCOPED_TRACE(seed);
    const Instance instance = random_instance(seed, 3, 3, 26);
    const PlanningProblem problem(instance, CollisionRule::kContinuous);
    const std::size_t least = sum_of_steps(solved(problem, kClCbs));
    const std::size_t some = sum_of_steps(solved(problem, kEccr));
    EXPECT_LE(least, some);
    optimal += least;
    focal += some;
  }
  EXPECT_LT(optimal, focal);
}

TEST(Eccr, AvoidsRobotsOutsideTheGroupWhereThatIsCheap) {
  const Instance instance = circle(2);
  const PlanningProblem problem(instance, CollisionRule::kContinuous);
  // Robot 1 drives straight on; robot 0 is a group of its own.
  const SweptTrajectory straight(problem.car(1), problem.starts()[1],
                                 std::vector<Arc>(30, Arc{1, 0}));
  const std::vector<const SweptTrajectory*> others = {&straight};
  const std::vector<CbsRobot> group = {all_robots(problem)[0]};
  const CbsResult result = conflict_based_search(
      group, others, SpacetimeHybridAstar(problem.curves()), kEccr, Deadline::never());
  ASSERT_EQ(result.failure, CbsFailure::kNone);
  const SweptTrajectory own(problem.car(0), problem.starts()[0], result.steps[0]);
  EXPECT_TRUE(find_conflicts_of(0, own, {{own, straight}}).empty());
}

TEST(Conflicts, OfOneRobotAreThoseOfAllThatNameIt) {
  const Instance instance = circle(4);
  const PlanningProblem problem(instance, CollisionRule::kContinuous);
  std::vector<SweptTrajectory> motions;
  for (int i = 0; i < problem.size(); ++i) {
    motions.emplace_back(problem.car(i), problem.starts()[std::size_t(i)],
                         std::vector<Arc>(30, Arc{1, 0}));
  }
  std::vector<Conflict> expected = find_conflicts(motions);
  EXPECT_GT(expected.size(), 20U);
  EXPECT_TRUE(std::ranges::is_sorted(expected));
  std::erase_if(expected, [](const Conflict& c) { return c.i != 2 && c.j != 2; });
  EXPECT_EQ(find_conflicts_of(2, motions[2], motions), expected);
}

}  // namespace
}  // namespace mvtp
