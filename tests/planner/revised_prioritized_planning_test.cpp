#include "planner/anytime/revised_prioritized_planning.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "planner/problem/validate.hpp"
#include "tests/planner/joint_scene.hpp"
#include "tests/planner/scenes.hpp"

namespace mvtp {
namespace {

constexpr std::int64_t kEnough = 1'000'000;
constexpr double kNorth = std::numbers::pi / 2;

/// Everyone in turn, and what the referee says of it.
class RevisedPrioritizedPlanningTest : public testing::Test {
 protected:
  void take(Instance instance, std::int64_t expansions = kEnough) {
    scene_.emplace(std::move(instance));
    motion_.emplace(scene_->robots, scene_->time);
    RevisedPrioritizedPlanning planning(*motion_, scene_->alone, scene_->never);
    planning.run(expansions);
    departed_.clear();
    for (int i = 0; i < motion_->size(); ++i) departed_.push_back(planning.has_departed(i));
  }

  void expect_all_departed() const {
    EXPECT_EQ(departed_, std::vector<bool>(departed_.size(), true));
    scene_->expect_valid(*motion_);
  }

  std::optional<JointScene> scene_;
  std::optional<JointMotion> motion_;
  std::vector<bool> departed_;
};

/// Walls along a lane from west to east that no two cars can pass each other in.
Map with_lane(Map map, double from, double to, double y) {
  map.polygons = {{{from, -1}, {to, -1}, {to, y - 1.5}, {from, y - 1.5}},
                  {{from, y + 1.5}, {to, y + 1.5}, {to, 41}, {from, 41}}};
  return map;
}

//   Whatever the order of their numbers, the first in the queue goes first: its start is on the
//   path of the rest.
TEST_F(RevisedPrioritizedPlanningTest, AQueueDrivesOff) {
  for (const bool reversed : {false, true}) {
    Instance queue{.agents = {}, .map = with_lane(empty_map(40), -1, 21, 20)};
    for (int i = 0; i < 5; ++i) {
      const int place = reversed ? 4 - i : i;
      queue.agents.push_back(agent({2.0 + 4.0 * place, 20, 0}, {34, 4.0 + 7.0 * place, 0}, i));
    }
    take(queue, 300);  // in any other order somebody searches in vain for longer
    expect_all_departed();
  }
}

//   The one before the entrance closes the dead end for the one behind it, who must go first.
TEST_F(RevisedPrioritizedPlanningTest, ADeadEndIsFilledFromItsEnd) {
  Instance dead_end{.agents = {}, .map = with_lane(empty_map(40), 20, 41, 20)};
  dead_end.agents = {agent({9, 20, 0}, {24, 20, 0}, 0), agent({3, 20, 0}, {36, 20, 0}, 1)};
  take(dead_end);
  expect_all_departed();
}

//   Nose to nose there is no turn to take: both stand where they were.
TEST_F(RevisedPrioritizedPlanningTest, WhoFindsNoPathStandsAtItsStart) {
  const Instance swap{
      .agents = {agent({5, 20, 0}, {36, 20, 0}, 0), agent({32, 20, 0}, {2, 20, 0}, 1)},
      .map = with_lane(empty_map(40), -1, 41, 20)};
  take(swap);
  EXPECT_EQ(departed_, std::vector<bool>({false, false}));
  EXPECT_TRUE(motion_->conflicts().empty());
  EXPECT_EQ(motion_->makespan(), 0);
}

//   Parked 0.7 m behind one and before another, who stay: only a larger and finer search gets it
//   out.
TEST_F(RevisedPrioritizedPlanningTest, WhoFailsIsLookedAtMoreFinely) {
  take({.agents = {agent({15.2, 15, 0}, {15.2, 22, 0}, 0), agent({18.9, 15, 0}, {18.9, 15, 0}, 1),
                   agent({11.5, 15, 0}, {11.5, 15, 0}, 2)},
        .map = empty_map(30)});
  expect_all_departed();
}

//   Robot 1 rests in a gap of a wall. The next gap is far, but nobody drives through a robot at
//   rest.
TEST_F(RevisedPrioritizedPlanningTest, PathsLeadRoundThoseThatStayHoweverFar) {
  Instance wall{.agents = {agent({3, 6, 0}, {20, 6, 0}, 0),
                           agent({10.5, 4.8, kNorth}, {10.5, 4.8, kNorth}, 1)},
                .map = {.width = 30, .height = 50}};
  wall.map.polygons = {{{10, 0}, {11, 0}, {11, 4}, {10, 4}},
                       {{10, 8}, {11, 8}, {11, 40}, {10, 40}},
                       {{10, 46}, {11, 46}, {11, 50}, {10, 50}}};
  take(wall);
  expect_all_departed();
}

TEST_F(RevisedPrioritizedPlanningTest, WithoutExpansionsNobodyDeparts) {
  take(random_instance(11, 30, 5, 45), 0);
  EXPECT_EQ(departed_, std::vector<bool>(30, false));
  EXPECT_EQ(motion_->makespan(), 0);
}

TEST_F(RevisedPrioritizedPlanningTest, ACrowdIsLedThroughItself) {
  take(random_instance(11, 30, 5, 45));
  expect_all_departed();
}

}  // namespace
}  // namespace mvtp
