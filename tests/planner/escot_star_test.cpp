#include "planner/anytime/escot_star.hpp"

#include <gtest/gtest.h>

#include "planner/anytime/exchange.hpp"
#include "planner/anytime/repair.hpp"
#include "planner/problem/validate.hpp"
#include "planner/solve.hpp"
#include "tests/planner/joint_scene.hpp"
#include "tests/planner/scenes.hpp"

namespace mvtp {
namespace {

Plan star(const Instance& instance, SolveOptions options = {}, double seconds = 60) {
  options.algorithm = "escot-star";
  return solve(instance, options, Deadline::in(seconds));
}

void expect_valid(const Instance& instance, const Plan& plan) {
  EXPECT_EQ(plan.statistics.status, "solved") << plan.statistics.reason;
  for (const Violation& violation : find_violations(instance, plan, CollisionRule::kContinuous)) {
    ADD_FAILURE() << violation.message;
  }
  EXPECT_GE(plan.statistics.makespan, plan.statistics.lower_bound - 1e-6);
}

class StarOnACircle : public testing::TestWithParam<int> {};

TEST_P(StarOnACircle, IsNearlyAtTheBound) {
  const Instance instance = circle(GetParam());
  const Plan plan = star(instance, {.gap = 0.2});
  expect_valid(instance, plan);
  EXPECT_LE(plan.statistics.makespan, 1.2 * plan.statistics.lower_bound);
  EXPECT_LE(*plan.statistics.first_solution, plan.statistics.runtime);
  EXPECT_LE(*plan.statistics.solo_makespan, plan.statistics.makespan + 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Robots, StarOnACircle, testing::Values(2, 4, 8));

TEST(EscotStar, StopsAtTheGap) {
  const Instance instance = random_instance(3, 12, 0, 40);
  for (const double gap : {0.02, 0.2}) {
    const Plan plan = star(instance, {.gap = gap});
    expect_valid(instance, plan);
    EXPECT_LE(plan.statistics.makespan, (1 + gap) * plan.statistics.lower_bound);
  }
}

TEST(EscotStar, SameSeedSamePlanOtherSeedOtherPlan) {
  const Instance instance = random_instance(8, 16, 6, 36);
  const SolveOptions options{.seed = 1, .gap = 0.05};
  const Plan plan = star(instance, options);
  expect_valid(instance, plan);
  EXPECT_EQ(plan.trajectories, star(instance, options).trajectories);
  EXPECT_NE(plan.trajectories, star(instance, {.seed = 2, .gap = 0.05}).trajectories);
}

TEST(EscotStar, ThreadsGiveTheSamePlanEachTime) {
  const Instance instance = random_instance(8, 16, 6, 36);
  const SolveOptions options{.gap = 0.05, .threads = 2};
  const Plan plan = star(instance, options);
  expect_valid(instance, plan);
  EXPECT_EQ(plan.trajectories, star(instance, options).trajectories);
}

//   More than one conflict per robot on their single-agent paths: found window by window.
TEST(EscotStar, SolvesACrowd) {
  const Instance instance = random_instance(4, 36, 3, 40);
  const Plan plan = star(instance, {.gap = 0.4});
  expect_valid(instance, plan);
  EXPECT_LE(plan.statistics.makespan, 1.4 * plan.statistics.lower_bound);
}

TEST(EscotStar, SaysThatTheTimeRanOut) {
  const Instance instance = random_instance(2, 25, 0, 30);
  const Plan plan = star(instance, {}, 1e-4);
  EXPECT_EQ(plan.statistics.status, "timeout");
  EXPECT_TRUE(plan.trajectories.empty());
}

TEST(EscotStar, SolvesNothingAndStandingStill) {
  EXPECT_EQ(star({.agents = {}, .map = empty_map(20)}).statistics.status, "solved");
  const Instance rest{.agents = {agent({5, 5, 1}, {5, 5, 1})}, .map = empty_map(20)};
  const Plan plan = star(rest);
  expect_valid(rest, plan);
  EXPECT_EQ(plan.statistics.makespan, 0.0);
}

//   At half the speed all takes twice as long, and nothing else changes.
TEST(EscotStar, SlowRobotsDriveTheSamePlan) {
  const Instance quick = circle(2);
  Instance slow = quick;
  slow.dt *= 2;
  for (Agent& a : slow.agents) a.vehicle.max_speed /= 2;
  const Plan plan = star(quick, {.gap = 0.2});
  const Plan slow_plan = star(slow, {.gap = 0.2});
  EXPECT_DOUBLE_EQ(slow_plan.statistics.dt, 2 * plan.statistics.dt);
  EXPECT_EQ(slow_plan.statistics.makespan_steps, plan.statistics.makespan_steps);
}

/// A crowd, made ready for the parts of the algorithm.
class StarParts : public testing::Test, protected JointScene {
 protected:
  StarParts() : JointScene(random_instance(11, 30, 5, 45)) {}

  /// Everybody along its single-agent path, conflicts and all.
  void place_all_alone(JointMotion& motion) const { motion.place_all(alone); }
};

//   The pairs in conflict are those that the referee finds, which knows nothing of boxes and
//   macro steps.
TEST_F(StarParts, ConflictsAreThoseOfTheReferee) {
  JointMotion motion(robots, time);
  place_all_alone(motion);
  std::vector<std::vector<std::string>> expected;
  for (const Violation& v :
       find_violations(instance, plan_of(motion), CollisionRule::kContinuous)) {
    ASSERT_EQ(v.rule, Rule::kRobotOverlap) << v.message;
    if (std::ranges::find(expected, v.agents) == expected.end()) expected.push_back(v.agents);
  }
  std::vector<std::vector<std::string>> found;
  for (const auto& [i, j] : motion.conflicts()) {
    found.push_back({instance.agents[std::size_t(i)].name, instance.agents[std::size_t(j)].name});
  }
  std::ranges::sort(expected);
  std::ranges::sort(found);
  EXPECT_GT(found.size(), 10U);
  EXPECT_EQ(found, expected);
}

TEST_F(StarParts, RemovingAndPlacingAgainChangesNothing) {
  JointMotion motion(robots, time);
  place_all_alone(motion);
  std::vector<JointMotion::Pair> before = motion.conflicts();
  motion.set_weight(before.front().first, before.front().second, 2.5F);
  const double cost = motion.cost();
  EXPECT_EQ(cost, double(before.size()) + 1.5);
  for (int i = 0; i < motion.size(); ++i) {
    ArcTrajectory trajectory = motion.remove(i);
    EXPECT_TRUE(motion.conflicts_of(i).empty());
    motion.place(i, std::move(trajectory));
  }
  std::vector<JointMotion::Pair> after = motion.conflicts();
  std::ranges::sort(before);
  std::ranges::sort(after);
  EXPECT_EQ(before, after);
  EXPECT_EQ(motion.cost(), cost);
}

//   What would overlap is what does once it is there.
TEST_F(StarParts, OverlapsAreCountedBeforehand) {
  JointMotion motion(robots, time);
  place_all_alone(motion);
  constexpr int kAll = 1000;
  int most = 0;
  for (int i = 0; i < motion.size(); ++i) {
    const int expected = int(motion.conflicts_of(i).size());
    ArcTrajectory trajectory = motion.remove(i);
    EXPECT_EQ(motion.overlaps(i, trajectory, kAll), expected);
    EXPECT_EQ(motion.overlaps(i, trajectory, 1), std::min(expected, 1));
    const int wait = 1 + i % 20;
    const int later = motion.overlaps(i, trajectory, kAll, wait);
    motion.place(i, motion.trajectory_after(i, wait, trajectory.steps()));
    EXPECT_EQ(later, int(motion.conflicts_of(i).size()));
    motion.remove(i);
    motion.place(i, std::move(trajectory));
    most = std::max(most, expected);
  }
  EXPECT_GT(most, 2);
}

//   However long the two stand in each other.
TEST(JointMotion, CountsEachOneOnce) {
  const Instance instance{
      .agents = {agent({5, 5, 0}, {30, 20, 0}, 0), agent({5, 30, 0}, {30, 20, 0}, 1),
                 agent({5, 37, 0}, {35, 37, 0}, 2)},
      .map = empty_map(40)};
  const JointScene scene(instance);
  JointMotion motion(scene.robots, scene.time);
  motion.place(0, scene.alone[0]);
  motion.place(2, motion.trajectory_after(2, 600, scene.alone[2].steps()));
  EXPECT_EQ(motion.overlaps(1, scene.alone[1], 3), 1);
}

TEST_F(StarParts, RepairEndsWithoutConflictsOrSaysSo) {
  JointMotion motion(robots, time);
  Repair repair(motion, alone, {}, 1, never);
  place_all_alone(motion);
  EXPECT_FALSE(repair.run(1'000'000, [] { return true; }));
  EXPECT_TRUE(repair.run(5'000'000, [] { return false; }));
  EXPECT_TRUE(find_violations(instance, plan_of(motion), CollisionRule::kContinuous).empty());
}

TEST_F(StarParts, TighteningKeepsToTheLimit) {
  JointMotion motion(robots, time);
  Repair repair(motion, alone, {}, 1, never);
  motion.place_all(alone);
  ASSERT_TRUE(repair.run(200'000, [] { return false; }));
  const int limit = (motion.makespan() + int(planning_problem.lower_bound() / time.dt)) / 2;
  ASSERT_LT(limit, motion.makespan());
  bool unreachable = false;
  ASSERT_TRUE(repair.tighten(
      limit, 200'000, 5000, [] { return false; }, unreachable));
  EXPECT_LE(motion.makespan(), limit);
  EXPECT_FALSE(unreachable);
  EXPECT_TRUE(find_violations(instance, plan_of(motion), CollisionRule::kContinuous).empty());
}

//   Two cars nose to nose in a lane that is no wider than one: the repair stagnates.
TEST(Repair, GivesUpWithoutProgress) {
  Map lane{.width = 40, .height = 3.0};
  lane.bounds = Bounds::kAxle;
  lane.polygons = {{{-9, -3}, {49, -3}, {49, 0}, {-9, 0}}, {{-9, 3}, {49, 3}, {49, 6}, {-9, 6}}};
  const Instance swap{
      .agents = {agent({5, 1.5, 0}, {30, 1.5, 0}), agent({35, 1.5, 0}, {10, 1.5, 0})}, .map = lane};
  const JointScene scene(swap);
  JointMotion motion(scene.robots, scene.time);
  Repair repair(motion, scene.alone, {}, 1, scene.never);
  motion.place_all(scene.alone);
  EXPECT_FALSE(repair.run(20'000, [] { return false; }));
  EXPECT_EQ(motion.conflicts().size(), 1U);
  EXPECT_GE(repair.expansions(), 20'000);
}

//   The goal of robot 1 is in a lane for one that robot 0 has to drive through: however robot 0 is
//   planned anew, robot 1 is there before it. It is robot 1 that has to wait.
TEST(Repair, PlansBothOfAPairAlternately) {
  Map lane = empty_map(40);
  lane.polygons = {{{14, -1}, {30, -1}, {30, 18.5}, {14, 18.5}},
                   {{14, 21.5}, {30, 21.5}, {30, 41}, {14, 41}}};
  const JointScene scene(
      {.agents = {agent({4, 8, 0}, {36, 20, 0}, 0), agent({8, 20, 0}, {22, 20, 0}, 1)},
       .map = lane});
  JointMotion motion(scene.robots, scene.time);
  Repair repair(motion, scene.alone, {}, 1, scene.never);
  motion.place_all(scene.alone);
  ASSERT_EQ(motion.conflicts().size(), 1U);
  EXPECT_TRUE(repair.run(20'000, [] { return false; }));
  scene.expect_valid(motion);
}

TEST_F(StarParts, ShorteningKeepsThePlanValidAndNeverDelays) {
  JointMotion motion(robots, time);
  Repair repair(motion, alone, {}, 1, never);
  place_all_alone(motion);
  ASSERT_TRUE(repair.run(5'000'000, [] { return false; }));
  const std::int64_t before = motion.flowtime();
  int shortened = 0;
  for (int i = 0; i < motion.size(); ++i) {
    const int arrival = motion.trajectory(i).arrival();
    if (repair.shorten(i, 2000)) {
      ++shortened;
      EXPECT_LT(motion.trajectory(i).arrival(), arrival);
    } else {
      EXPECT_EQ(motion.trajectory(i).arrival(), arrival);
    }
  }
  EXPECT_GT(shortened, 0);
  EXPECT_LT(motion.flowtime(), before);
  EXPECT_TRUE(find_violations(instance, plan_of(motion), CollisionRule::kContinuous).empty());
}

//   A horizon hides what comes later, and nothing else; moved on, it shows all.
TEST_F(StarParts, ConflictsBehindTheHorizonDoNotCount) {
  JointMotion all(robots, time);
  place_all_alone(all);
  const auto pairs = [](const JointMotion& motion) {
    std::vector<JointMotion::Pair> result = motion.conflicts();
    std::ranges::sort(result);
    return result;
  };
  constexpr int kHorizon = 10;
  JointMotion motion(robots, time);
  motion.set_horizon(kHorizon, kHorizon);
  for (int i = 0; i < all.size(); ++i) motion.place(i, all.trajectory(i));
  std::vector<JointMotion::Pair> early;
  for (const auto& [i, j] : pairs(all)) {
    bool meeting = false;
    for (int t = 0; t < kHorizon * time.macro_step && !meeting; t += time.macro_step) {
      meeting =
          meet(all.trajectory(i).boxes(t), robots[std::size_t(i)].car->shape(),
               all.trajectory(j).boxes(t), robots[std::size_t(j)].car->shape(), time.macro_step);
    }
    if (meeting) early.emplace_back(i, j);
  }
  EXPECT_EQ(pairs(motion), early);
  EXPECT_LT(motion.conflicts().size(), all.conflicts().size());
  for (int end = kHorizon + 5; end < 100; end += 5) motion.set_horizon(end, end);
  EXPECT_EQ(pairs(motion), pairs(all));
  EXPECT_EQ(motion.cost(), all.cost());
}

TEST(Exchange, HandsTheBestPlanToEveryone) {
  Exchange exchange(1, 10);
  ConflictFreePlan plan;
  EXPECT_FALSE(exchange.meet(0, plan, false));
  plan = {std::vector<ArcTrajectory>(1), 20, 20};
  EXPECT_FALSE(exchange.meet(0, plan, false));
  ConflictFreePlan worse{std::vector<ArcTrajectory>(1), 30, 30};
  EXPECT_FALSE(exchange.meet(0, worse, false));
  EXPECT_EQ(worse.makespan, 20);
  ConflictFreePlan good{std::vector<ArcTrajectory>(1), 9, 9};
  EXPECT_TRUE(exchange.meet(0, good, false));
}

TEST(Exchange, EndsWhenEveryoneHas) {
  Exchange exchange(1, 0);
  ConflictFreePlan none;
  EXPECT_TRUE(exchange.meet(0, none, true));
}

}  // namespace
}  // namespace mvtp
