#include "planner/anytime/first_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "planner/anytime/windows.hpp"
#include "tests/planner/joint_scene.hpp"
#include "tests/planner/scenes.hpp"

namespace mvtp {
namespace {

const Repair::Interrupt kNever = [] { return false; };

/// Queues of three on five lanes to the east and on five to the north, 6 m apart, and one robot
/// that has much further to go, beside them all: the ones have time to go when the others are
/// through.
Instance crossing_lanes() {
  Instance instance{.agents = {}, .map = empty_map(90), .dt = 1.0};
  const auto add = [&](const Pose& start, const Pose& goal) {
    instance.agents.push_back(agent(start, goal, int(instance.agents.size())));
  };
  for (int lane = 0; lane < 5; ++lane) {
    const double side = 22.0 + 6 * lane;
    for (int place = 0; place < 3; ++place) {
      const double start = 16.0 - 6 * place;
      const double north = std::numbers::pi / 2;
      add({start, side, 0}, {start + 48, side, 0});
      add({side, start, north}, {side, start + 48, north});
    }
  }
  add({3, 86, 0}, {85, 86, 0});
  return instance;
}

//   Nobody needs to be planned anew who only has to begin later.
TEST(FirstPlan, ACrowdIsSpreadOut) {
  const JointScene scene(crossing_lanes());
  JointMotion motion(scene.robots, scene.time);
  motion.place_all(scene.alone);
  ASSERT_TRUE(needs_windows(motion)) << motion.conflicts().size();
  Repair repair(motion, scene.alone, {}, 1, scene.never);
  ASSERT_TRUE(FirstPlan(motion, repair, scene.alone, scene.never, kNever).find());
  scene.expect_valid(motion);
  EXPECT_EQ(repair.expansions(), 0);
  EXPECT_LE(motion.makespan(), 1.25 * scene.alone.back().arrival());
}

TEST(FirstPlan, CrowdsAndOthersEndWithoutConflicts) {
  for (const int robots : {6, 40}) {
    const JointScene scene(random_instance(11, robots, 5, 45));
    JointMotion motion(scene.robots, scene.time);
    motion.place_all(scene.alone);
    EXPECT_EQ(needs_windows(motion), robots == 40) << motion.conflicts().size();
    Repair repair(motion, scene.alone, {}, 1, scene.never);
    ASSERT_TRUE(FirstPlan(motion, repair, scene.alone, scene.never, kNever).find());
    EXPECT_FALSE(motion.has_horizon());
    scene.expect_valid(motion);
  }
}

//   So much later than the one with the longest path may they arrive, unless there is no such plan.
TEST(FirstPlan, ACrowdKeepsToItsLimit) {
  for (const std::uint64_t seed : {0U, 5U, 8U, 10U}) {
    const JointScene scene(random_instance(seed, 14, 6, 30));
    JointMotion motion(scene.robots, scene.time);
    motion.place_all(scene.alone);
    ASSERT_TRUE(needs_windows(motion)) << motion.conflicts().size();
    Repair repair(motion, scene.alone, {}, 1, scene.never);
    ASSERT_TRUE(FirstPlan(motion, repair, scene.alone, scene.never, kNever).find());
    int longest = 0;
    for (const ArcTrajectory& path : scene.alone) longest = std::max(longest, path.arrival());
    EXPECT_LE(motion.makespan(), 1.25 * longest) << seed;
  }
}

//   Nose to nose in a lane for one, nobody ever gets to its goal: to stand at the start is no plan.
TEST(FirstPlan, ThereIsNoneForTwoThatCannotPass) {
  Map lane{.width = 40, .height = 3.0};
  lane.bounds = Bounds::kAxle;
  lane.polygons = {{{-9, -3}, {49, -3}, {49, 0}, {-9, 0}}, {{-9, 3}, {49, 3}, {49, 6}, {-9, 6}}};
  const JointScene scene(
      {.agents = {agent({5, 1.5, 0}, {30, 1.5, 0}, 0), agent({35, 1.5, 0}, {10, 1.5, 0}, 1)},
       .map = lane});
  JointMotion motion(scene.robots, scene.time);
  Repair repair(motion, scene.alone, {}, 1, scene.never);
  const auto enough = [&] { return repair.expansions() > 10'000; };
  EXPECT_FALSE(FirstPlan(motion, repair, scene.alone, scene.never, enough).find());
}

//   Robot 0 gets out of its place between two walls by a path that a small search does not find.
TEST(FirstPlan, WhoFindsNoOtherPathDrivesItsOwn) {
  Instance tight{
      .agents = {agent({15.2, 15, 0}, {15.2, 22, 0}, 0), agent({4, 26, 0}, {24, 26, 0}, 1)},
      .map = empty_map(30),
      .dt = 1.0};
  tight.map.polygons = {{{13, 13}, {14, 13}, {14, 17}, {13, 17}},
                        {{18.4, 13}, {19.4, 13}, {19.4, 17}, {18.4, 17}}};
  const JointScene scene(tight);
  JointMotion motion(scene.robots, scene.time);
  Repair repair(motion, scene.alone, {}, 1, scene.never);
  ASSERT_TRUE(FirstPlan(motion, repair, scene.alone, scene.never, kNever).find());
  EXPECT_TRUE(motion.present(0));
  EXPECT_TRUE(motion.present(1));
  scene.expect_valid(motion);
}

TEST(Windows, EndOnceNobodyOverlapsAtAnyTime) {
  const JointScene scene(random_instance(11, 30, 5, 45));
  JointMotion motion(scene.robots, scene.time);
  motion.place_all(scene.alone);
  const std::size_t all = motion.conflicts().size();
  Repair repair(motion, scene.alone, {}, 1, scene.never);
  int windows = 0;
  ASSERT_TRUE(resolve_by_windows(motion, [&] {
    EXPECT_TRUE(motion.has_horizon());
    if (windows++ == 0) {
      EXPECT_LT(motion.conflicts().size(), all);
    }
    return repair.run(5'000'000, kNever);
  }));
  EXPECT_GT(windows, 2);
  EXPECT_FALSE(motion.has_horizon());
  EXPECT_TRUE(motion.conflicts().empty());
  scene.expect_valid(motion);
}

//   Whoever takes the horizon away has resolved all that there is.
TEST(Windows, EndWithTheHorizon) {
  const JointScene scene(random_instance(11, 30, 5, 45));
  JointMotion motion(scene.robots, scene.time);
  motion.place_all(scene.alone);
  int windows = 0;
  EXPECT_TRUE(resolve_by_windows(motion, [&] {
    ++windows;
    return motion.place_all(scene.alone);
  }));
  EXPECT_EQ(windows, 1);
  EXPECT_FALSE(motion.has_horizon());
}

TEST(Windows, EndWhenOneIsGivenUp) {
  const JointScene scene(random_instance(11, 30, 5, 45));
  JointMotion motion(scene.robots, scene.time);
  motion.place_all(scene.alone);
  int windows = 0;
  EXPECT_FALSE(resolve_by_windows(motion, [&] { return ++windows < 2; }));
  EXPECT_EQ(windows, 2);
}

}  // namespace
}  // namespace mvtp
