#include "planner/escot/stepped_world.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <tuple>

#include "planner/escot/escot.hpp"
#include "tests/planner/scenes.hpp"

namespace mvtp {
namespace {

using testing::Contains;
using testing::ElementsAre;

constexpr double kPi = std::numbers::pi;
const Deadline kNever = Deadline::never();

/// Robots on an empty map, as ESCoT sees them step by step.
class World {
 public:
  explicit World(std::vector<Agent> agents, const SteppedWorldOptions& options = {})
      : instance_{.agents = std::move(agents), .map = empty_map(60), .dt = 1.0},
        problem_(instance_, CollisionRule::kContinuous),
        world_(problem_, options, kNever),
        q_(problem_.starts()) {
    world_.update_reference_paths(q_);
  }

  [[nodiscard]] SteppedWorld& operator*() { return world_; }
  [[nodiscard]] SteppedWorld* operator->() { return &world_; }
  [[nodiscard]] const Configuration& q() const { return q_; }
  [[nodiscard]] const SteppedCar& car(int i) const { return problem_.car(i); }

  void drive(const std::vector<SteppedWorld::Motion>& motions) {
    world_.advance(motions);
    for (std::size_t i = 0; i < q_.size(); ++i) q_[i] = motions[i].end;
    world_.update_reference_paths(q_);
  }
  void wait(int steps) {
    for (int t = 0; t < steps; ++t) {
      std::vector<SteppedWorld::Motion> stops;
      for (int i = 0; i < problem_.size(); ++i) stops.push_back(stop(i));
      drive(stops);
    }
  }
  [[nodiscard]] SteppedWorld::Motion stop(int i) const {
    return world_.safe_stop(i, q_[std::size_t(i)]);
  }
  /// What robot i would like best.
  [[nodiscard]] Arc first(int i) const {
    auto ranking = world_.candidates(i, q_[std::size_t(i)]);
    return nth(ranking, 0)->arc;
  }

 private:
  Instance instance_;
  PlanningProblem problem_;
  SteppedWorld world_;
  Configuration q_;
};

/// Two robots that come towards each other from west and east, 12 m apart.
std::vector<Agent> head_on(double y, int number) {
  return {agent({10, y, 0}, {40, y, 0}, number), agent({22, y, kPi}, {4, y, kPi}, number + 1)};
}

//   Two pairs far from each other. One of the first pair stays behind: the plan of the others is
//   kept.
TEST(SteppedWorld, AJointTrajectoryEndsForItsOwnGroupOnly) {
  std::vector<Agent> agents = head_on(10, 0);
  for (const Agent& a : head_on(45, 2)) agents.push_back(a);
  World world(agents);
  ASSERT_THAT(world->group_robots(world.q()), ElementsAre(Group{0, 1}, Group{2, 3}));
  world.drive(generate_config(*world, world.q()));
  std::vector<SteppedWorld::Motion> motions = generate_config(*world, world.q());
  motions[0] = world.stop(0);
  world.drive(motions);
  EXPECT_THAT(world->group_robots(world.q()), Contains(Group{2, 3}));
}

//   Robots 0 and 2 meet first, robot 1 crosses the path of 2 behind them.
TEST(SteppedWorld, GroupsAreInOrderWhoeverMeetsFirst) {
  const double north = kPi / 2;
  World world({agent({20, 13.5, north}, {20, 40, north}, 0), agent({13, 11, 0}, {40, 11, 0}, 1),
               agent({20, 19, -north}, {20, 4, -north}, 2)});
  EXPECT_THAT(world->group_robots(world.q()), ElementsAre(Group{0, 1, 2}));
}

TEST(SteppedWorld, AGroupThatCannotBePlannedIsTriedAgainLater) {
  SteppedWorldOptions options;
  options.eccr.max_expansions = 1;  // no group is planned
  options.eccr.max_nodes = 1;
  World world(head_on(10, 0), options);
  world.wait(10);
  const Group both = {0, 1};
  ASSERT_TRUE(world->pre_check(both));
  ASSERT_FALSE(world->get_opt_traj(world.q(), both).front());
  for (int t = 0; t < options.retry_after; ++t) {
    EXPECT_FALSE(world->pre_check(both)) << t;
    world.wait(1);
  }
  EXPECT_TRUE(world->pre_check(both));
}

//   To turn is worth it for a goal to the left, and not for one that is nearly ahead.
TEST(SteppedWorld, WithoutAReferencePathARobotTurnsForMuchOnly) {
  SteppedWorldOptions options;
  options.reference_path_expansions = 0;  // finds none
  const auto first = [&](double direction) {
    const Pose goal{30 + 20 * std::cos(direction), 30 + 20 * std::sin(direction), direction};
    return World({agent({30, 30, 0}, goal)}, options).first(0);
  };
  EXPECT_EQ(first(0.35), (Arc{1.0, 0.0}));
  EXPECT_GT(first(1.0).curvature, 0.0);
}

//   What is drawn is tried before the reference path.
TEST(SteppedWorld, ARobotThatRepeatsItselfMayActAtRandom) {
  int random = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    World world({agent({30, 30, 0}, {50, 30, 0})});
    const Arc ahead = world.first(0);
    std::mt19937_64 rng(seed);
    world->add_randomness(world.q(), rng);
    random += world.first(0) != ahead ? 1 : 0;
  }
  EXPECT_GT(random, 10);
  EXPECT_LT(random, 50);
}

//   In a lane as wide as one car they only push each other to and fro. Configurations between two
//   equal ones are removed, again and again.
TEST(Escot, NoConfigurationComesTwice) {
  Instance lane{
      .agents = {agent({5, 1.5, 0}, {25, 1.5, 0}, 0), agent({14, 1.5, kPi}, {4, 1.5, kPi}, 1)},
      .map = {.width = 30, .height = 3},
      .dt = 1.0};
  const PlanningProblem problem(lane, CollisionRule::kContinuous);
  const PlannerResult result =
      solve_escot(problem, {.world = {.grouping = false}, .max_steps = 300}, kNever);
  ASSERT_EQ(result.status, Status::kExhausted);
  std::set<std::vector<std::int64_t>> seen;
  const std::size_t steps = result.trajectories.front().makespan();
  for (std::size_t t = 0; t <= steps; ++t) {
    std::vector<std::int64_t> places;  // [mm], [mrad]
    for (const Trajectory& trajectory : result.trajectories) {
      const Pose& pose = trajectory.at(t).pose;
      for (const double value : {pose.x, pose.y, pose.theta}) {
        places.push_back(std::llround(value / 0.001));
      }
    }
    EXPECT_TRUE(seen.insert(places).second) << "step " << t;
  }
  EXPECT_GT(seen.size(), 1U);
}

TEST(Escot, AStepOfLessThanAMillimetreIsAStep) {
  const Instance near{
      .agents = {agent({10, 10, 0}, {10.0002, 10, 0})}, .map = empty_map(20), .dt = 1.0};
  const PlanningProblem problem(near, CollisionRule::kContinuous);
  const PlannerResult result = solve_escot(problem, {.max_steps = 10}, kNever);
  EXPECT_EQ(result.status, Status::kSolved);
  EXPECT_EQ(result.trajectories.front().makespan(), 1U);
}

}  // namespace
}  // namespace mvtp
