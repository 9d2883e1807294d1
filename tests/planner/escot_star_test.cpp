#include "planner/algorithms/escot_star.hpp"

#include <gtest/gtest.h>

#include "planner/algorithms/exchange.hpp"
#include "planner/algorithms/repair.hpp"
#include "planner/algorithms/solve.hpp"
#include "planner/problem/validate.hpp"
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

//   More than one conflict per robot on their ways alone: found window by window.
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

/// A crowd, made ready for the parts of the algorithm.
class StarParts : public testing::Test {
 protected:
  StarParts()
      : instance(random_instance(11, 30, 5, 45)),
        fleet(instance, CollisionRule::kContinuous),
        obstacles(instance.map, 6.0),
        clearance(instance.map, obstacles) {
    cars.reserve(instance.agents.size());
    for (int i = 0; i < fleet.size(); ++i) {
      const Agent& a = instance.agents[std::size_t(i)];
      cars.emplace_back(a.vehicle, time, instance.map, obstacles, clearance);
      robots.push_back({&cars.back(), &fleet.cost_to_go(i), a.start});
    }
  }

  /// Everybody along its way alone, conflicts and all.
  void place_all_alone(JointMotion& motion, Repair& repair) {
    for (int i = 0; i < motion.size(); ++i) {
      std::optional<TimedTrack> track = repair.plan_alone(i, 1.5, 5000);
      ASSERT_TRUE(track);
      motion.place(i, *std::move(track));
    }
  }

  /// The plan of these tracks, without the robots in `left_out`.
  Plan plan_of(const JointMotion& motion) const {
    Plan plan;
    plan.statistics.dt = time.dt;
    for (int i = 0; i < motion.size(); ++i) {
      Trajectory trajectory(motion.track(i).start());
      Pose pose = motion.track(i).start();
      for (const Arc& arc : motion.track(i).steps()) {
        pose = fleet.after(i, pose, arc);
        trajectory.push_back({pose, arc.length / time.dt, std::atan(arc.curvature * 2.0)});
      }
      plan.names.push_back(instance.agents[std::size_t(i)].name);
      plan.trajectories.push_back(trajectory);
    }
    return plan;
  }

  TimeGrid time{0.1, 12};
  Instance instance;
  Fleet fleet;
  Obstacles obstacles;
  Clearance clearance;
  std::vector<MacroCar> cars;
  std::vector<MacroRobot> robots;
  Deadline never = Deadline::never();
};

//   The pairs in conflict are those that the referee finds, which knows nothing of boxes and
//   buckets.
TEST_F(StarParts, ConflictsAreThoseOfTheReferee) {
  JointMotion motion(robots, time);
  Repair repair(motion, {}, 1, never);
  place_all_alone(motion, repair);
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
  Repair repair(motion, {}, 1, never);
  place_all_alone(motion, repair);
  std::vector<JointMotion::Pair> before = motion.conflicts();
  motion.set_weight(before.front().first, before.front().second, 2.5F);
  const double cost = motion.cost();
  EXPECT_EQ(cost, double(before.size()) + 1.5);
  for (int i = 0; i < motion.size(); ++i) {
    TimedTrack track = motion.remove(i);
    EXPECT_TRUE(motion.conflicts_of(i).empty());
    motion.place(i, std::move(track));
  }
  std::vector<JointMotion::Pair> after = motion.conflicts();
  std::ranges::sort(before);
  std::ranges::sort(after);
  EXPECT_EQ(before, after);
  EXPECT_EQ(motion.cost(), cost);
}

TEST_F(StarParts, RepairEndsWithoutConflictsOrSaysSo) {
  JointMotion motion(robots, time);
  Repair repair(motion, {}, 1, never);
  place_all_alone(motion, repair);
  EXPECT_FALSE(repair.run(1'000'000, [] { return true; }));
  EXPECT_TRUE(repair.run(5'000'000, [] { return false; }));
  EXPECT_TRUE(find_violations(instance, plan_of(motion), CollisionRule::kContinuous).empty());
}

TEST_F(StarParts, LoweringKeepsToTheLimit) {
  JointMotion motion(robots, time);
  Repair repair(motion, {}, 1, never);
  std::vector<TimedTrack> alone;
  for (int i = 0; i < motion.size(); ++i) alone.push_back(*repair.plan_alone(i, 1.5, 5000));
  motion.place_all(alone);
  ASSERT_TRUE(repair.run(200'000, [] { return false; }));
  const int limit = (motion.makespan() + int(fleet.lower_bound() / time.dt)) / 2;
  ASSERT_LT(limit, motion.makespan());
  bool unreachable = false;
  ASSERT_TRUE(repair.lower(
      limit, 200'000, 5000, alone, [] { return false; }, unreachable));
  EXPECT_LE(motion.makespan(), limit);
  EXPECT_FALSE(unreachable);
  EXPECT_TRUE(find_violations(instance, plan_of(motion), CollisionRule::kContinuous).empty());
}

//   Two cars nose to nose in a lane that is no wider than one: the repair comes to a halt.
TEST(Repair, GivesUpWithoutProgress) {
  Map lane{.width = 40, .height = 3.0};
  lane.bounds = Bounds::kAxle;
  lane.polygons = {{{-9, -3}, {49, -3}, {49, 0}, {-9, 0}}, {{-9, 3}, {49, 3}, {49, 6}, {-9, 6}}};
  const Instance swap{
      .agents = {agent({5, 1.5, 0}, {30, 1.5, 0}), agent({35, 1.5, 0}, {10, 1.5, 0})}, .map = lane};
  const Fleet fleet(swap, CollisionRule::kContinuous);
  const Obstacles obstacles(swap.map, 6.0);
  const Clearance clearance(swap.map, obstacles);
  const TimeGrid time{0.1, 12};
  std::vector<MacroCar> cars;
  std::vector<MacroRobot> robots;
  cars.reserve(2);
  for (int i = 0; i < 2; ++i) {
    cars.emplace_back(fleet.car(i).vehicle(), time, swap.map, obstacles, clearance);
    robots.push_back({&cars.back(), &fleet.cost_to_go(i), swap.agents[std::size_t(i)].start});
  }
  const Deadline never = Deadline::never();
  JointMotion motion(robots, time);
  Repair repair(motion, {}, 1, never);
  for (int i = 0; i < 2; ++i) motion.place(i, *repair.plan_alone(i, 1.5, 500));
  EXPECT_FALSE(repair.run(20'000, [] { return false; }));
  EXPECT_EQ(motion.conflicts().size(), 1U);
  EXPECT_GE(repair.expansions(), 20'000);
}

TEST_F(StarParts, ShorteningKeepsThePlanValidAndNeverDelays) {
  JointMotion motion(robots, time);
  Repair repair(motion, {}, 1, never);
  place_all_alone(motion, repair);
  ASSERT_TRUE(repair.run(5'000'000, [] { return false; }));
  const std::int64_t before = motion.flowtime();
  int shortened = 0;
  for (int i = 0; i < motion.size(); ++i) {
    const int arrival = motion.track(i).arrival();
    if (repair.shorten(i, 2000)) {
      ++shortened;
      EXPECT_LT(motion.track(i).arrival(), arrival);
    } else {
      EXPECT_EQ(motion.track(i).arrival(), arrival);
    }
  }
  EXPECT_GT(shortened, 0);
  EXPECT_LT(motion.flowtime(), before);
  EXPECT_TRUE(find_violations(instance, plan_of(motion), CollisionRule::kContinuous).empty());
}

//   A horizon hides what comes later, and nothing else; moved on, it shows all.
TEST_F(StarParts, ConflictsBehindTheHorizonDoNotCount) {
  JointMotion all(robots, time);
  Repair repair(all, {}, 1, never);
  place_all_alone(all, repair);
  const auto pairs = [](const JointMotion& motion) {
    std::vector<JointMotion::Pair> result = motion.conflicts();
    std::ranges::sort(result);
    return result;
  };
  constexpr int kHorizon = 10;
  JointMotion motion(robots, time);
  motion.set_horizon(kHorizon, kHorizon);
  for (int i = 0; i < all.size(); ++i) motion.place(i, all.track(i));
  std::vector<JointMotion::Pair> early;
  for (const auto& [i, j] : pairs(all)) {
    bool meeting = false;
    for (int t = 0; t < kHorizon * time.bucket && !meeting; t += time.bucket) {
      meeting = meet(all.track(i).boxes(t), robots[std::size_t(i)].car->shape(),
                     all.track(j).boxes(t), robots[std::size_t(j)].car->shape(), time.bucket);
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
  Incumbent plan;
  EXPECT_FALSE(exchange.meet(0, plan, false));
  plan = {std::vector<TimedTrack>(1), 20, 20};
  EXPECT_FALSE(exchange.meet(0, plan, false));
  Incumbent worse{std::vector<TimedTrack>(1), 30, 30};
  EXPECT_FALSE(exchange.meet(0, worse, false));
  EXPECT_EQ(worse.makespan, 20);
  Incumbent good{std::vector<TimedTrack>(1), 9, 9};
  EXPECT_TRUE(exchange.meet(0, good, false));
}

TEST(Exchange, EndsWhenEveryoneHas) {
  Exchange exchange(1, 0);
  Incumbent none;
  EXPECT_TRUE(exchange.meet(0, none, true));
}

}  // namespace
}  // namespace mvtp
