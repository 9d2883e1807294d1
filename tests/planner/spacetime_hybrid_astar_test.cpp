#include "planner/search/spacetime_hybrid_astar.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <set>

#include "planner/escot/planning_problem.hpp"
#include "tests/planner/scenes.hpp"

namespace mvtp {
namespace {

constexpr double kPi = std::numbers::pi;
const Deadline kNever = Deadline::never();

/// A room of 30 x 30 m with a wall at x = 15, open for 6 m at the top.
Map room() {
  Map map = empty_map(30);
  map.polygons = {{{14.5, 0}, {15.5, 0}, {15.5, 24}, {14.5, 24}}};
  return map;
}

class SpacetimeSearch : public testing::Test {
 protected:
  static Instance instance_of(const Map& map, std::vector<Agent> agents) {
    return {.agents = std::move(agents), .map = map, .dt = 1.0};
  }
  static SearchProblem problem(const PlanningProblem& planning_problem, int i) {
    SearchProblem result;
    result.car = &planning_problem.car(i);
    result.cost_to_go = &planning_problem.cost_to_go(i);
    result.start = planning_problem.starts()[std::size_t(i)];
    return result;
  }
  static void expect_free_path_to_goal(const PlanningProblem& planning_problem, int i,
                                       const SearchResult& path) {
    Pose pose = planning_problem.starts()[std::size_t(i)];
    for (const Arc& arc : path.steps) {
      EXPECT_TRUE(planning_problem.car(i).is_free(pose, arc));
      EXPECT_LE(std::abs(arc.length), planning_problem.car(i).step_length());
      pose = planning_problem.after(i, pose, arc);
    }
    EXPECT_EQ(pose, planning_problem.goal(i));
  }
};

TEST_F(SpacetimeSearch, FindsTheReedsSheppPathWhereNothingBlocksIt) {
  const Instance instance = instance_of(empty_map(50), {agent({10, 10, 0}, {30, 20, kPi / 2})});
  const PlanningProblem planning_problem(instance, CollisionRule::kContinuous);
  const auto path = SpacetimeHybridAstar(planning_problem.curves())
                        .search(problem(planning_problem, 0), {}, kNever);
  ASSERT_TRUE(path);
  expect_free_path_to_goal(planning_problem, 0, *path);
  EXPECT_LE(double(path->steps.size()),
            planning_problem.lower_bound() + 5.0);  // one short step per piece
}

TEST_F(SpacetimeSearch, GoesRoundAWall) {
  const Instance instance = instance_of(room(), {agent({7, 5, kPi / 2}, {23, 5, -kPi / 2})});
  const PlanningProblem planning_problem(instance, CollisionRule::kContinuous);
  const auto path = SpacetimeHybridAstar(planning_problem.curves())
                        .search(problem(planning_problem, 0), {}, kNever);
  ASSERT_TRUE(path);
  expect_free_path_to_goal(planning_problem, 0, *path);
  EXPECT_GT(path->steps.size(), 40U);
}

TEST_F(SpacetimeSearch, GivesUpWhereThereIsNoPath) {
  Map map = empty_map(30);
  map.polygons = {{{14.5, 0}, {15.5, 0}, {15.5, 30}, {14.5, 30}}};
  const Instance instance = instance_of(map, {agent({7, 5, 0}, {23, 5, 0})});
  const PlanningProblem planning_problem(instance, CollisionRule::kContinuous);
  EXPECT_FALSE(SpacetimeHybridAstar(planning_problem.curves())
                   .search(problem(planning_problem, 0), {}, kNever));
}

//   [0>] ........ [<1]   robot 1 comes straight at robot 0, which gives way at the cost of a step
//   or two: no conflicts, within w of the straight path.
TEST_F(SpacetimeSearch, KeepsClearOfARobotThatComesTowardsIt) {
  const Instance instance = instance_of(empty_map(50), {agent({10, 25, 0}, {40, 25, 0}, 0),
                                                        agent({40, 25, -kPi}, {10, 25, -kPi}, 1)});
  const PlanningProblem planning_problem(instance, CollisionRule::kContinuous);
  const SpacetimeHybridAstar planner(planning_problem.curves());
  const auto straight = planner.search(problem(planning_problem, 1), {}, kNever);
  ASSERT_TRUE(straight);
  const SweptTrajectory oncoming(planning_problem.car(1), planning_problem.starts()[1],
                                 straight->steps);
  const std::vector<const SweptTrajectory*> others = {&oncoming};
  SearchProblem avoiding = problem(planning_problem, 0);
  const TimedObstacles traffic(others);
  const std::vector<const TimedObstacles*> to_avoid = {&traffic};
  avoiding.to_avoid = to_avoid;
  const auto path = planner.search(avoiding, {}, kNever);
  ASSERT_TRUE(path);
  expect_free_path_to_goal(planning_problem, 0, *path);
  EXPECT_EQ(path->conflicts, 0);
  EXPECT_LE(path->cost, 1.5 * path->lower_bound + 1e-9);
  const SweptTrajectory own(planning_problem.car(0), planning_problem.starts()[0], path->steps);
  for (int t = 0; t < 60; ++t) EXPECT_FALSE(collide(own.at(t), oncoming.at(t)));
}

//   Out of expansions, it is the best path so far that counts: the more of them, the fewer
//   conflicts.
TEST_F(SpacetimeSearch, FindsPathsWithFewerAndFewerConflicts) {
  const Instance instance = random_instance(12, 12, 0, 30);
  const PlanningProblem planning_problem(instance, CollisionRule::kContinuous);
  std::vector<SweptTrajectory> straight_on;
  for (int i = 1; i < planning_problem.size(); ++i) {
    straight_on.emplace_back(planning_problem.car(i), planning_problem.starts()[std::size_t(i)],
                             std::vector<Arc>(30, Arc{1, 0}));
  }
  std::vector<const SweptTrajectory*> others;
  for (const SweptTrajectory& other : straight_on) others.push_back(&other);
  const TimedObstacles traffic(others);
  const std::vector<const TimedObstacles*> to_avoid = {&traffic};
  SearchProblem avoiding = problem(planning_problem, 0);
  avoiding.to_avoid = to_avoid;
  std::set<int> conflicts;
  for (int most = 1; most <= 100; ++most) {
    const auto path = SpacetimeHybridAstar(planning_problem.curves())
                          .search(avoiding, {.max_expansions = most}, kNever);
    ASSERT_TRUE(path);
    if (!conflicts.empty()) {
      EXPECT_LE(path->conflicts, *conflicts.begin()) << most;
    }
    conflicts.insert(path->conflicts);
  }
  EXPECT_GT(conflicts.size(), 3U);
}

//   The robot stands at its goal when another one has to pass: it leaves and comes back.
TEST_F(SpacetimeSearch, LeavesItsGoalForAConstraintAndComesBack) {
  const Instance instance = instance_of(empty_map(30), {agent({15, 15, 0}, {15, 15, 0})});
  const PlanningProblem planning_problem(instance, CollisionRule::kContinuous);
  const std::vector<Constraint> constraints = {
      {5, 8, planning_problem.car(0).sweep({15, 15, kPi / 2}, {})}};
  SearchProblem constrained = problem(planning_problem, 0);
  constrained.constraints = constraints;
  const auto path = SpacetimeHybridAstar(planning_problem.curves()).search(constrained, {}, kNever);
  ASSERT_TRUE(path);
  expect_free_path_to_goal(planning_problem, 0, *path);
  const SweptTrajectory own(planning_problem.car(0), planning_problem.starts()[0], path->steps);
  for (int t = 5; t <= 8; ++t) EXPECT_FALSE(collide(own.at(t), constraints[0].sweep));
}

//   Boxed in so tightly that a full step hits a wall in every direction; half a step does not.
TEST_F(SpacetimeSearch, ShorterArcsFindThePathOutOfATightPlace) {
  Map map = empty_map(30);
  // Blocks ahead and behind leave 0.7 m; the path out is to edge forwards and backwards.
  map.polygons = {{{13.2, 13}, {14.2, 13}, {14.2, 17}, {13.2, 17}},
                  {{18.6, 13}, {19.6, 13}, {19.6, 17}, {18.6, 17}}};
  const Instance instance = instance_of(map, {agent({15.2, 15, 0}, {15.2, 22, 0})});
  const PlanningProblem planning_problem(instance, CollisionRule::kContinuous);
  const SpacetimeHybridAstar planner(planning_problem.curves());
  EXPECT_FALSE(
      planner.search(problem(planning_problem, 0), {.w = 1.2, .max_expansions = 20000}, kNever));
  const auto path = planner.search(problem(planning_problem, 0),
                                   {.w = 1.2, .max_expansions = 20000, .arc_scale = 0.5}, kNever);
  ASSERT_TRUE(path);
  expect_free_path_to_goal(planning_problem, 0, *path);
}

//   Another robot drives over the goal at steps 25 ... 30: it is reached only after that.
TEST_F(SpacetimeSearch, ArrivesWhenNobodyComesByTheGoalAnyMore) {
  const Instance instance = instance_of(
      empty_map(50),
      {agent({20, 25, 0}, {30, 25, 0}, 0), agent({31, 5, kPi / 2}, {31, 45, kPi / 2}, 1)});
  const PlanningProblem planning_problem(instance, CollisionRule::kContinuous);
  std::vector<Arc> late(8);  // waits
  late.resize(48, Arc{1, 0});
  const SweptTrajectory passing(planning_problem.car(1), planning_problem.starts()[1], late);
  const std::vector<const SweptTrajectory*> others = {&passing};
  const TimedObstacles traffic(others);
  SearchProblem careful = problem(planning_problem, 0);
  careful.to_keep_clear_of = &traffic;
  const auto path =
      SpacetimeHybridAstar(planning_problem.curves()).search(careful, {.w = 1.0}, kNever);
  ASSERT_TRUE(path);
  expect_free_path_to_goal(planning_problem, 0, *path);
  EXPECT_GT(path->steps.size(), 28U);
  EXPECT_LT(path->steps.size(), 36U);
  const SweptTrajectory own(planning_problem.car(0), planning_problem.starts()[0], path->steps);
  for (int t = 0; t < 60; ++t) EXPECT_FALSE(collide(own.at(t), passing.at(t)));
}

TEST_F(SpacetimeSearch, FindsNoWayToAGoalThatAnotherRobotKeeps) {
  const Instance instance = instance_of(
      empty_map(50), {agent({20, 25, 0}, {30, 25, 0}, 0), agent({30, 5, 0}, {30, 26, 0}, 1)});
  const PlanningProblem planning_problem(instance, CollisionRule::kContinuous);
  const SweptTrajectory standing(planning_problem.car(1), {30, 26, 0}, {});
  const std::vector<const SweptTrajectory*> others = {&standing};
  const TimedObstacles traffic(others);
  SearchProblem careful = problem(planning_problem, 0);
  careful.to_keep_clear_of = &traffic;
  EXPECT_FALSE(SpacetimeHybridAstar(planning_problem.curves()).search(careful, {}, kNever));
}

TEST_F(SpacetimeSearch, EndsAtTheDeadline) {
  const Instance instance = instance_of(empty_map(50), {agent({10, 10, 0}, {30, 20, kPi / 2})});
  const PlanningProblem planning_problem(instance, CollisionRule::kContinuous);
  EXPECT_FALSE(SpacetimeHybridAstar(planning_problem.curves())
                   .search(problem(planning_problem, 0), {}, Deadline::in(0)));
}

TEST(SteppedCar, PrimitivesAreItsStepsFromAnywhere) {
  const Instance instance = circle(2);
  for (const CollisionRule rule : {CollisionRule::kContinuous, CollisionRule::kSteps}) {
    const PlanningProblem planning_problem(instance, rule);
    const SteppedCar& car = planning_problem.car(0);
    const std::vector<Primitive> primitives = car.primitives(0.5);
    ASSERT_EQ(primitives.size(), 7U);
    EXPECT_EQ(primitives.back().arc, Arc{});
    for (const Primitive& primitive : primitives) {
      const Pose from{12, 17, 3.0};
      const Frame frame(from);
      const Pose end = primitive.end_from(from, frame);
      const Pose expected = drive(from, primitive.arc);
      EXPECT_LT(distance(end, expected), 1e-12);
      EXPECT_NEAR(end.theta, expected.theta, 1e-12);
      const Sweep sweep = primitive.sweep.moved_to(frame);
      const Sweep same = car.sweep(from, primitive.arc);
      EXPECT_NEAR(sweep.at(1.0).x, same.at(1.0).x, 1e-12);
      EXPECT_NEAR(sweep.at(0.0).y, same.at(0.0).y, 1e-12);
      EXPECT_EQ(sweep.radius(), same.radius());
    }
  }
}

TEST(TimedObstacles, NobodyIsLookedAtFromTheGivenStepOn) {
  const Instance instance = circle(2);
  const PlanningProblem planning_problem(instance, CollisionRule::kContinuous);
  const SweptTrajectory parked(planning_problem.car(0), {}, std::vector<Arc>(5));
  const std::vector<const SweptTrajectory*> pointers = {&parked};
  const TimedObstacles traffic(pointers, 3);
  const Sweep there = planning_problem.car(1).sweep({}, {});
  EXPECT_TRUE(traffic.hit(there, 2));
  EXPECT_FALSE(traffic.hit(there, 3));
  EXPECT_EQ(traffic.count(there, 7), 0);
  EXPECT_EQ(traffic.end(), 3);
}

//   Robot 0 has parked 44 m away from the one that asks, long before that one can be there.
TEST(TimedObstacles, WhoIsReachedLateIsKeptInMind) {
  const Instance instance = circle(2);
  const PlanningProblem planning_problem(instance, CollisionRule::kContinuous);
  const SteppedCar& car = planning_problem.car(0);
  const SweptTrajectory parks(car, {40, 4, 0}, std::vector<Arc>(4, Arc{1, 0}));
  const std::vector<const SweptTrajectory*> pointers = {&parks};
  const std::vector<Reach> asks = {{.from = {0, 4}, .at_start = 3.0, .per_step = 1.0}};
  const TimedObstacles traffic(pointers, TimedObstacles::kForEver, asks);
  EXPECT_TRUE(traffic.hit(car.sweep({44, 4, 0}, {}), 44));
  EXPECT_FALSE(traffic.hit(car.sweep({36, 4, 0}, {}), 44));
}

TEST(TimedObstacles, CountsWhoeverCollidesAtAStep) {
  const Instance instance = random_instance(11, 12, 0, 30);
  const PlanningProblem planning_problem(instance, CollisionRule::kContinuous);
  std::vector<SweptTrajectory> robots;
  for (int i = 1; i < planning_problem.size(); ++i) {
    const std::vector<Arc> steps(std::size_t(2 * i),
                                 planning_problem.car(i).arcs()[std::size_t(i % 6)]);
    robots.emplace_back(planning_problem.car(i), planning_problem.starts()[std::size_t(i)], steps);
  }
  std::vector<const SweptTrajectory*> pointers;
  for (const SweptTrajectory& robot : robots) pointers.push_back(&robot);
  const TimedObstacles traffic(pointers);
  EXPECT_EQ(traffic.end(), 22);
  int collisions = 0;
  for (int t = 0; t < 40; ++t) {
    for (double x = 2; x < 30; x += 2) {
      const Sweep sweep =
          planning_problem.car(0).sweep({x, 30 - x, x}, planning_problem.car(0).arcs()[1]);
      const auto expected = int(std::ranges::count_if(
          robots, [&](const SweptTrajectory& other) { return collide(sweep, other.at(t)); }));
      EXPECT_EQ(traffic.count(sweep, t), expected);
      EXPECT_EQ(traffic.hit(sweep, t), expected > 0);
      collisions += expected;
    }
  }
  EXPECT_GT(collisions, 100);
}

}  // namespace
}  // namespace mvtp
