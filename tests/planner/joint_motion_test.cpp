#include "planner/search/joint_motion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/planner/joint_scene.hpp"
#include "tests/planner/scenes.hpp"

namespace mvtp {
namespace {

using testing::IsEmpty;

/// Three cars on lanes of their own: two short paths out, and a long one.
class Departures : public testing::Test {
 protected:
  Departures()
      : scene_({.agents = {agent({3, 5, 0}, {8, 5, 0}, 0), agent({3, 15, 0}, {8, 15, 0}, 1),
                           agent({3, 25, 0}, {33, 25, 0}, 2)},
                .map = empty_map(40)}),
        motion_(scene_.robots, scene_.time) {}

  /// Straight ahead for so many time steps, begun `wait` macro steps later, and out.
  [[nodiscard]] ArcTrajectory path_out(int i, int time_steps, int wait = 0) const {
    const std::vector<Arc> steps_driven(std::size_t(time_steps), Arc{0.1, 0.0});
    return motion_.trajectory_after(i, wait, steps_driven, true);
  }
  [[nodiscard]] ArcTrajectory long_path() const {
    return motion_.trajectory_after(2, 0, std::vector<Arc>(300, Arc{0.1, 0.0}));
  }

  [[nodiscard]] ArcTrajectory standing(int i, const Pose& pose) const {
    return {motion_.robot(i).car->vehicle(), pose, {}, scene_.time.macro_step};
  }

  JointScene scene_;
  JointMotion motion_;
};

TEST_F(Departures, TwoThatHaveLeftMeetNobody) {
  motion_.place(0, path_out(0, 50));
  motion_.place(1, path_out(1, 50));
  motion_.place(2, long_path());  // it alone is there in the end
  EXPECT_THAT(motion_.conflicts(), IsEmpty());
}

TEST_F(Departures, WhoLeavesBlocksNobodyWhicheverIsPlacedFirst) {
  motion_.place(2, long_path());
  motion_.place(0, path_out(0, 40));
  EXPECT_EQ(motion_.overlaps(1, path_out(1, 50), 3), 0);
  motion_.place(1, path_out(1, 50));
  EXPECT_THAT(motion_.conflicts_of(1), IsEmpty());
}

TEST_F(Departures, AnExitIsNotDelayedByAnEarlierOne) {
  motion_.place(2, long_path());
  motion_.place(0, path_out(0, 50));
  const std::vector<Arc> steps_driven(50, Arc{0.1, 0.0});
  ASSERT_TRUE(motion_.place_later(1, steps_driven, 200, true));
  EXPECT_EQ(motion_.trajectory(1).arrival(), 50);
}

//   Until the end of the macro step in which it arrives it is there, and not a macro step longer.
TEST_F(Departures, ThePathOutItselfCounts) {
  motion_.place(0, path_out(0, 50));
  const MacroRobot& second = motion_.robot(1);
  const auto standing = [&] {
    return ArcTrajectory(second.car->vehicle(), {9.5, 5, 0}, {}, scene_.time.macro_step);
  };
  EXPECT_EQ(motion_.overlaps(1, standing(), 3), 1);
  const int departure = motion_.trajectory(0).departure();
  EXPECT_EQ(departure, 60);
  const ArcTrajectory late(second.car->vehicle(), {9.5 - 0.1 * departure, 12, 0},
                           std::vector<Arc>(std::size_t(departure), Arc{0.1, 0.0}),
                           scene_.time.macro_step);
  EXPECT_EQ(motion_.overlaps(1, late, 3), 0);
}

TEST_F(Departures, WhoArrivesAtOnceIsThereForOneMacroStep) {
  EXPECT_EQ(path_out(0, 0).departure(), scene_.time.macro_step);
  motion_.place(0, path_out(0, 0));
  const ArcTrajectory standing(motion_.robot(1).car->vehicle(), {4, 5, 0}, {},
                               scene_.time.macro_step);
  EXPECT_EQ(motion_.overlaps(1, standing, 3), 1);
}

//   With thousands of robots, placing them all takes long.
TEST_F(Departures, PlacingAllEndsAtTheDeadline) {
  EXPECT_FALSE(motion_.place_all(scene_.alone, Deadline::in(0)));
  EXPECT_FALSE(motion_.present(0));
  EXPECT_TRUE(motion_.place_all(scene_.alone));
  EXPECT_TRUE(motion_.present(2));
}

TEST(Clearance, KnowsNothingIfTheTimeRunsOut) {
  Map map = empty_map(40);
  map.polygons = {{{30, 30}, {35, 30}, {30, 35}}};
  const Obstacles obstacles(map, 4.0);
  EXPECT_GT(Clearance(map, obstacles).at(5, 5), 5.0F);
  EXPECT_EQ(Clearance(map, obstacles, Deadline::in(0)).at(5, 5), 0.0F);
}

TEST_F(Departures, AConflictEndsWithTheRobotThatHasIt) {
  motion_.place(0, standing(0, {3, 5, 0}));
  motion_.place(1, standing(1, {4, 5, 0}));
  EXPECT_TRUE(motion_.in_conflict(0, 1));
  EXPECT_EQ(motion_.cost(), 1.0);
  motion_.remove(1);
  EXPECT_FALSE(motion_.in_conflict(0, 1));
  EXPECT_THAT(motion_.conflicts(), IsEmpty());
  EXPECT_EQ(motion_.cost(), 0.0);
}

TEST_F(Departures, APlanForAllTakesThePlaceOfTheOneBefore) {
  const ArcTrajectory third = standing(2, {3, 25, 0});
  motion_.place_all({standing(0, {3, 5, 0}), standing(1, {4, 5, 0}), third});
  EXPECT_EQ(motion_.conflicts().size(), 1U);
  motion_.place_all({standing(0, {3, 5, 0}), standing(1, {3, 15, 0}), third});
  EXPECT_THAT(motion_.conflicts(), IsEmpty());
}

TEST_F(Departures, ASearchSeesPairsAtTheirWeights) {
  motion_.place(1, standing(1, {3, 15, 0}));
  motion_.set_weight(0, 1, 3.0F);
  EXPECT_EQ(motion_.others(0, 10.0).soft_costs[1], 30.0F);
  EXPECT_EQ(motion_.others(0, 10.0).soft_costs[2], 10.0F);
}

}  // namespace
}  // namespace mvtp
