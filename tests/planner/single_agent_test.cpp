#include <gtest/gtest.h>

#include "planner/escot/single_agent_path.hpp"
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

}  // namespace
}  // namespace mvtp
