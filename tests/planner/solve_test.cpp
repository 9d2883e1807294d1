#include "planner/solve.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "planner/escot/escot.hpp"
#include "planner/problem/input_error.hpp"
#include "planner/problem/metrics.hpp"
#include "planner/problem/validate.hpp"
#include "tests/planner/scenes.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Solves and lets the referee judge.
Plan judged(const Instance& instance, const SolveOptions& options = {}) {
  Plan plan = solve(instance, options, Deadline::in(60));
  EXPECT_EQ(plan.statistics.status, "solved") << plan.statistics.reason;
  for (const Violation& violation : find_violations(instance, plan, options.collision)) {
    ADD_FAILURE() << violation.message;
  }
  for (std::size_t i = 0; i < plan.trajectories.size(); ++i) {
    EXPECT_EQ(plan.trajectories[i].waypoints().back().pose, instance.agents[i].goal);
  }
  EXPECT_GE(plan.statistics.makespan, plan.statistics.lower_bound - 1e-6);
  return plan;
}

class OnACircle : public testing::TestWithParam<int> {};

TEST_P(OnACircle, EscotLetsRobotsPassEachOther) {
  const Plan plan = judged(circle(GetParam()));
  EXPECT_LE(plan.statistics.makespan, 1.5 * plan.statistics.lower_bound);
}

INSTANTIATE_TEST_SUITE_P(Robots, OnACircle, testing::Values(2, 4, 8));

TEST(Escot, IsQuickerThanPbcrAlone) {
  for (const int robots : {4, 8}) {
    const Plan pbcr = judged(circle(robots), {.algorithm = "pbcr"});
    const Plan escot = judged(circle(robots));
    EXPECT_LT(escot.statistics.makespan_steps, pbcr.statistics.makespan_steps);
  }
}

//   Nose to nose, a pushed robot cannot turn away any more and is driven back, for hundreds of
//   steps: it has to leave the lane of the other one in time.
TEST(Pbcr, RobotsHeadOnGiveWayInTime) {
  EXPECT_LE(judged(circle(2), {.algorithm = "pbcr"}).statistics.makespan_steps, 45U);
  EXPECT_LE(judged(circle(8), {.algorithm = "pbcr"}).statistics.makespan_steps, 100U);
}

//   A loop is left by what is drawn at random. Planned together as if nothing had been drawn, the
//   same two would drive into it for ever.
TEST(Escot, ADrawnPrimitiveIsNotPlannedAway) {
  const Instance instance = circle(2, 6.0);
  const PlanningProblem problem(instance, CollisionRule::kContinuous);
  const Deadline never = Deadline::never();
  const Configuration q = problem.starts();
  SteppedWorld world(problem, {}, never);
  world.update_reference_paths(q);
  ASSERT_THAT(SteppedWorld(world).group_robots(q), ElementsAre(Group{0, 1}));
  const auto next = [&q](SteppedWorld copy) { return generate_config(copy, q); };
  const std::vector<SteppedWorld::Motion> planned = next(world);

  int different = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SteppedWorld drawn = world;
    std::mt19937_64 rng(seed);
    drawn.add_randomness(q, rng);
    const std::vector<SteppedWorld::Motion> motions = next(drawn);
    different += motions[0].end != planned[0].end || motions[1].end != planned[1].end ? 1 : 0;
  }
  EXPECT_GE(different, 5);
}

//   Robots that groups do not help wait off their reference paths, and there the seed acts.
TEST(Escot, ADifferentSeedTriesOtherWays) {
  const Plan a = judged(circle(12), {.algorithm = "escot", .seed = 1});
  const Plan b = judged(circle(12), {.algorithm = "escot", .seed = 2});
  EXPECT_NE(a.trajectories, b.trajectories);
}

TEST(Pbcr, ADifferentSeedTriesOtherWays) {
  const Plan a = judged(circle(8), {.algorithm = "pbcr", .seed = 1});
  const Plan b = judged(circle(8), {.algorithm = "pbcr", .seed = 2});
  EXPECT_NE(a.trajectories, b.trajectories);
}

/// Each shard solves 26 instances of 2 to 6 robots, with up to 8 obstacles, on 24 to 30 m.
class RandomInstances : public testing::TestWithParam<int> {};

TEST_P(RandomInstances, EveryPlanSatisfiesTheReferee) {
  for (int k = 0; k < 26; ++k) {
    const int seed = 26 * GetParam() + k;
    SCOPED_TRACE(seed);
    const Instance instance =
        random_instance(std::uint64_t(seed), 2 + seed % 5, seed % 3 * 4, 24 + seed % 7);
    (void)judged(instance,
                 {.collision = seed % 4 == 0 ? CollisionRule::kSteps : CollisionRule::kContinuous});
  }
}

INSTANTIATE_TEST_SUITE_P(Shards, RandomInstances, testing::Range(0, 8));

class EveryAlgorithm : public testing::TestWithParam<std::string> {};

TEST_P(EveryAlgorithm, MakesPlansThatSatisfyTheReferee) {
  for (std::uint64_t seed = 500; seed < 510; ++seed) {
    SCOPED_TRACE(seed);
    const auto rule = seed % 4 == 0 ? CollisionRule::kSteps : CollisionRule::kContinuous;
    (void)judged(random_instance(seed, 2 + int(seed % 4), 4, 30),
                 {.algorithm = GetParam(), .collision = rule});
  }
}

TEST_P(EveryAlgorithm, GivesTheSamePlanForTheSameSeed) {
  const Instance instance = random_instance(7, 5, 4, 30);
  const SolveOptions options{.algorithm = GetParam(), .seed = 3};
  EXPECT_EQ(judged(instance, options).trajectories, judged(instance, options).trajectories);
}

TEST_P(EveryAlgorithm, EndsAtTheDeadline) {
  const Plan plan = solve(circle(8), {.algorithm = GetParam()}, Deadline::in(0));
  EXPECT_EQ(plan.statistics.status, "timeout");
  EXPECT_THAT(plan.statistics.reason, HasSubstr("time limit"));
}

TEST_P(EveryAlgorithm, TakesNoStepIfAllIsSolvedFromTheStart) {
  Instance instance = circle(3);
  for (Agent& a : instance.agents) a.goal = a.start;
  EXPECT_EQ(judged(instance, {.algorithm = GetParam()}).statistics.makespan_steps, 0U);
}

INSTANTIATE_TEST_SUITE_P(Names, EveryAlgorithm, testing::ValuesIn(algorithm_names()),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::erase(name, '-');
                           return name;
                         });

/// Ten robots on 30 x 30 m: much pushing.
class Crowd : public testing::TestWithParam<std::uint64_t> {};

//   The safe stop of a SteppedCar is its pose: after every step all may stay where they are.
TEST_P(Crowd, AfterEveryStepEverybodyMayStopAtOnce) {
  const Instance instance = random_instance(GetParam(), 10, 5, 30);
  const PlanningProblem problem(instance, CollisionRule::kContinuous);
  const Deadline never = Deadline::never();
  SteppedWorld world(problem, {}, never);
  std::mt19937_64 rng(GetParam());
  Configuration q = problem.starts();
  int moved = 0;
  for (int t = 0; t < 40; ++t) {
    world.update_reference_paths(q);
    if (t % 5 == 4) world.add_randomness(q, rng);
    const std::vector<SteppedWorld::Motion> motions = generate_config(world, q);
    for (int i = 0; i < problem.size(); ++i) {
      moved += motions[std::size_t(i)].end != q[std::size_t(i)] ? 1 : 0;
      q[std::size_t(i)] = motions[std::size_t(i)].end;
    }
    world.advance(motions);
    for (int i = 0; i < problem.size(); ++i) {
      const auto stop = world.safe_stop(i, q[std::size_t(i)]);
      ASSERT_TRUE(problem.car(i).is_free(q[std::size_t(i)], {}));
      for (int j = 0; j < i; ++j) {
        ASSERT_FALSE(world.conflict(i, stop, j, world.safe_stop(j, q[std::size_t(j)])));
        ASSERT_FALSE(world.conflict(i, motions[std::size_t(i)], j, motions[std::size_t(j)]));
      }
    }
  }
  EXPECT_GT(moved, 50);
}

//   Asked twice in one step, the second time nothing is taken as foreseen.
TEST_P(Crowd, GroupsAreTheSameWhateverWasForeseen) {
  const Instance instance = random_instance(GetParam(), 16, 3, 40);
  const PlanningProblem problem(instance, CollisionRule::kContinuous);
  const Deadline never = Deadline::never();
  SteppedWorld world(problem, {}, never);
  std::mt19937_64 rng(GetParam());
  Configuration q = problem.starts();
  int joined = 0;
  for (int t = 0; t < 60; ++t) {
    world.update_reference_paths(q);
    const std::vector<Group> groups = world.group_robots(q);
    ASSERT_EQ(groups, world.group_robots(q)) << "step " << t;
    for (const Group& group : groups) joined += group.size() > 1 ? 1 : 0;
    const std::vector<SteppedWorld::Motion> motions = generate_config(world, q);
    world.advance(motions);
    if (t % 8 == 7) world.add_randomness(q, rng);
    if (t % 13 == 12) continue;  // nobody moves after all, as when a loop is cut out
    for (std::size_t i = 0; i < q.size(); ++i) q[i] = motions[i].end;
  }
  EXPECT_GT(joined, 20);
}

//   A group that could not be planned is in mind only until it may be tried again.
TEST_P(Crowd, FailuresAreForgottenInTime) {
  const Instance instance = random_instance(GetParam(), 16, 3, 40);
  const PlanningProblem problem(instance, CollisionRule::kContinuous);
  const Deadline never = Deadline::never();
  SteppedWorldOptions options;
  options.eccr.max_nodes = 1;
  options.eccr.max_expansions = 1;  // no group is planned
  SteppedWorld world(problem, options, never);
  Configuration q = problem.starts();
  std::size_t most = 0;
  for (int t = 0; t < 60; ++t) {
    world.update_reference_paths(q);
    const std::vector<SteppedWorld::Motion> motions = generate_config(world, q);
    most = std::max(most, world.failures_kept());
    world.advance(motions);
    for (std::size_t i = 0; i < q.size(); ++i) q[i] = motions[i].end;
  }
  EXPECT_GT(most, 0U);
  for (int t = 0; t < options.retry_after; ++t) {  // nobody moves: nothing is tried
    std::vector<SteppedWorld::Motion> waits;
    for (int i = 0; i < problem.size(); ++i) waits.push_back(world.safe_stop(i, q[std::size_t(i)]));
    world.advance(waits);
  }
  EXPECT_EQ(world.failures_kept(), 0U);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Crowd, testing::Range(std::uint64_t{900}, std::uint64_t{906}));

TEST(Solve, ProvesThatABlockedGoalIsInfeasible) {
  Instance instance = circle(2);
  instance.map.circles = {{instance.agents[1].goal.x, instance.agents[1].goal.y, 0.8}};
  const Plan plan = solve(instance, {}, Deadline::in(60));
  EXPECT_EQ(plan.statistics.status, "infeasible");
  EXPECT_EQ(plan.statistics.reason, "the start of agent0 overlaps obstacle 0");
}

TEST(Solve, ProvesThatGoalsThatOverlapAreInfeasible) {
  Instance instance = circle(3);
  instance.agents[2].goal = instance.agents[0].goal;
  const Plan plan = solve(instance, {}, Deadline::in(60));
  EXPECT_EQ(plan.statistics.status, "infeasible");
  EXPECT_EQ(plan.statistics.reason, "the goals of agent0 and agent2 overlap");
}

/// A wall across a room of 30 x 30 m with a gap; the car is 2 m wide.
Instance room_with_gap(double gap) {
  Instance instance{.agents = {}, .map = empty_map(30), .dt = 1.0};
  instance.agents = {agent({4, 4, 0}, {8, 24, 1}, 0), agent({5, 15, 0}, {22, 15, 0}, 1)};
  instance.map.polygons = {{{14, 0}, {15, 0}, {15, 15 - gap / 2}, {14, 15 - gap / 2}},
                           {{14, 15 + gap / 2}, {15, 15 + gap / 2}, {15, 30}, {14, 30}}};
  return instance;
}

TEST(Solve, ProvesThatAGapNarrowerThanTheCarLetsNobodyThrough) {
  const Plan plan = solve(room_with_gap(1.98), {}, Deadline::in(60));
  EXPECT_EQ(plan.statistics.status, "infeasible");
  EXPECT_EQ(plan.statistics.reason,
            "no path for agent1 to its goal, even alone: every gap is narrower than it");
}

TEST(Solve, FindsAPathThroughAGapJustWiderThanTheCar) { (void)judged(room_with_gap(2.02)); }

//   Seen at whole steps only, a car gets through a wall thinner than its jumps.
TEST(Solve, DoesNotCallAWallClosedThatStepsJumpOver) {
  const Instance instance = room_with_gap(0.0);
  EXPECT_EQ(solve(instance, {}, Deadline::in(60)).statistics.status, "infeasible");
  Instance thin = instance;
  thin.map.polygons = {{{14, 0}, {14.01, 0}, {14.01, 30}, {14, 30}}};
  thin.dt = 4.0;
  (void)judged(thin, {.collision = CollisionRule::kSteps});
}

TEST(Solve, NamesTheAlgorithmsThereAre) {
  try {
    (void)solve(circle(2), {.algorithm = "magic"}, Deadline::in(1));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("unknown algorithm 'magic'; choose one of escot, pbcr"));
  }
}

//   The seed in the plan is the one that gives this plan again, not that of a run before it.
TEST(Solve, NamesTheSeedOfTheLastRun) {
  EXPECT_EQ(solve(circle(3), {.seed = 5, .runs = 3}, Deadline::in(60)).statistics.seed, 5U);
  Instance lane{.agents = {agent({2, 2, 0}, {12, 2, 0}, 0), agent({14, 2, 3.14}, {4, 2, 3.14}, 1)},
                .map = {.width = 18, .height = 4, .circles = {}, .polygons = {}}};
  const Plan plan = solve(lane, {.algorithm = "sha", .seed = 5, .runs = 3}, Deadline::in(60));
  EXPECT_EQ(plan.statistics.status, "exhausted");
  EXPECT_EQ(plan.statistics.seed, 7U);
}

TEST(Solve, TheLowerBoundIsTheLongestReedsSheppTime) {
  const Plan plan = solve(circle(2), {}, Deadline::in(60));
  EXPECT_NEAR(plan.statistics.lower_bound, 30.0, 1e-9);  // straight across at 1 m/s
}

}  // namespace
}  // namespace mvtp
