#include "planner/search/conflict.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planner/escot/planning_problem.hpp"
#include "tests/planner/scenes.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;

//   [0>[1>      1 stands on the nose of 0, drives away at once, and is apart after its first step.
TEST(Conflicts, BeginWithTheFirstStep) {
  const Instance instance{.agents = {agent({10, 10, 0}, {10, 30, 0})}, .map = empty_map(40)};
  const PlanningProblem problem(instance, CollisionRule::kContinuous);
  const SteppedCar& car = problem.car(0);
  const double touching = 10.0 + car.vehicle().length() - 0.2;
  const std::vector<Arc> away = {{1.0, 0.0}, {1.0, 0.0}};
  const std::vector<SweptTrajectory> robots = {SweptTrajectory(car, {10, 10, 0}, {}),
                                               SweptTrajectory(car, {touching, 10, 0}, away)};
  EXPECT_THAT(find_conflicts(robots), ElementsAre(Conflict{0, 0, 1}));
  EXPECT_THAT(find_conflicts_of(1, robots[1], robots), ElementsAre(Conflict{0, 0, 1}));
}

}  // namespace
}  // namespace mvtp
