#include <gtest/gtest.h>

#include "planner/anytime/single_agent_trajectories.hpp"
#include "planner/escot/single_agent_path.hpp"
#include "tests/planner/joint_scene.hpp"
#include "tests/planner/scenes.hpp"

namespace mvtp {
namespace {

TEST(SingleAgentPath, LeadsEachRobotFromItsStartToItsGoal) {
  const Instance instance = random_instance(3, 6, 4, 36);
  const PlanningProblem problem(instance, CollisionRule::kContinuous);
  for (int i = 0; i < problem.size(); ++i) {
    const auto path = find_single_agent_path(problem, i, Deadline::never());
    ASSERT_TRUE(path);
    Pose pose = problem.starts()[std::size_t(i)];
    for (const Arc& arc : *path) {
      EXPECT_TRUE(problem.car(i).is_free(pose, arc));
      pose = problem.after(i, pose, arc);
    }
    EXPECT_EQ(pose, problem.goal(i));
  }
}

//   0.7 m before and behind it are walls: steps of a metre, a quarter of what it drives in 4 s, do
//   not get it out of there. Finer searches do.
TEST(SingleAgentTrajectories, LeadOutOfPlacesThatAreTooTightForSteps) {
  Instance tight{.agents = {agent({15.2, 15, 0}, {15.2, 22, 0})}, .map = empty_map(30), .dt = 4.0};
  tight.map.polygons = {{{13, 13}, {14, 13}, {14, 17}, {13, 17}},
                        {{18.4, 13}, {19.4, 13}, {19.4, 17}, {18.4, 17}}};
  const JointScene scene(tight);
  ASSERT_FALSE(find_single_agent_path(scene.planning_problem, 0, Deadline::never()));
  ASSERT_EQ(scene.alone.size(), 1U);
  const ArcTrajectory& path = scene.alone.front();
  EXPECT_LT(distance(path.pose(path.arrival()), tight.agents[0].goal), 1e-6);
}

//   Alone, no place is worth another look at another time: the search of a room ends whose door is
//   5 cm too narrow on either side.
TEST(SingleAgentTrajectories, ThereIsNothingToWaitFor) {
  Instance closed{.agents = {agent({15, 15, 0}, {27, 15, 0})}, .map = empty_map(30), .dt = 1.0};
  closed.map.polygons = {{{9, 9}, {21, 9}, {21, 10}, {9, 10}},
                         {{9, 20}, {21, 20}, {21, 21}, {9, 21}},
                         {{9, 10}, {10, 10}, {10, 20}, {9, 20}},
                         {{20, 10}, {21, 10}, {21, 14.05}, {20, 14.05}},
                         {{20, 15.95}, {21, 15.95}, {21, 20}, {20, 20}}};
  const PlanningProblem problem(closed, CollisionRule::kContinuous);
  const Obstacles obstacles(closed.map, 6.0);
  const Clearance clearance(closed.map, obstacles);
  const MotionPrimitives car(closed.agents[0].vehicle, {0.1, 12}, closed.map, obstacles, clearance);
  const MacroRobot robot{&car, &problem.cost_to_go(0), closed.agents[0].start};
  const auto expansions = [&](int most) {
    SoftHybridAstar search(1);
    EXPECT_FALSE(find_single_agent_trajectory(search, robot, 2.0, most, 0, Deadline::never()));
    return search.expansions();
  };
  EXPECT_EQ(expansions(5'000), expansions(50'000));
}

}  // namespace
}  // namespace mvtp
