#include "planner/search/soft_hybrid_astar.hpp"

#include <gtest/gtest.h>

#include "planner/motion/reeds_shepp.hpp"
#include "tests/planner/scenes.hpp"

namespace mvtp {
namespace {

const Vehicle kCar{.front = 2.0, .rear = 1.0, .min_turning_radius = 3.0};
constexpr TimeGrid kTime{0.1059, 14};

/// One robot that is searched for, and one other.
struct Scene {
  explicit Scene(Map where, const Pose& goal)
      : map(std::move(where)),
        obstacles(map, 4.0),
        clearance(map, obstacles),
        car(kCar, kTime, map, obstacles, clearance),
        cost_to_go(goal, 3.0, ReedsSheppTable::shared(), std::make_shared<ObstacleGrid>(map, 0.8)) {
  }

  /// The other robot drives along the steps.
  void place_other(const Pose& start, const std::vector<Arc>& steps) {
    trajectories[1] = ArcTrajectory(kCar, start, steps, kTime.macro_step);
    occupancy.place(1, trajectories[1], car.shape());
  }

  [[nodiscard]] SoftProblem problem(const Pose& start) const {
    SoftProblem result;
    result.car = &car;
    result.cost_to_go = &cost_to_go;
    result.others = {&occupancy, trajectories, shapes, soft_costs};
    result.start = start;
    return result;
  }

  [[nodiscard]] ArcTrajectory trajectory(const Pose& start, const SoftResult& path) const {
    return {kCar, start, path.steps, kTime.macro_step};
  }

  Map map;
  Obstacles obstacles;
  Clearance clearance;
  MotionPrimitives car;
  CostToGo cost_to_go;
  Occupancy occupancy{2, kTime};
  std::vector<ArcTrajectory> trajectories{2};
  std::vector<BoxShape> shapes{box_shape(kCar, kTime.dt), box_shape(kCar, kTime.dt)};
  std::vector<float> soft_costs{10.0F, 10.0F};
};

/// From west to east, 50 m long and wide enough for one.
Map corridor() {
  Map map{.width = 50, .height = 3.0};
  map.bounds = Bounds::kAxle;
  map.polygons = {{{-9, -3}, {59, -3}, {59, 0}, {-9, 0}}, {{-9, 3}, {59, 3}, {59, 6}, {-9, 6}}};
  return map;
}

std::optional<SoftResult> search(const SoftProblem& problem, const SoftOptions& options = {}) {
  return SoftHybridAstar(2).search(problem, options, Deadline::never());
}

TEST(SoftHybridAstar, DrivesTheShortestCurveIfAlone) {
  const Pose start{10, 10, 0.3};
  const Pose goal{30, 25, 2.0};
  const Scene scene(empty_map(50), goal);
  const std::optional<SoftResult> path = search(scene.problem(start));
  ASSERT_TRUE(path);
  const double length = reeds_shepp_length(start, goal, 3.0);
  EXPECT_GE(int(path->steps.size()) * kTime.dt, length);
  EXPECT_LE(int(path->steps.size()) * kTime.dt, length + 5 * kTime.dt);
  EXPECT_LT(distance(drive(start, path->steps), goal), 1e-8);
  EXPECT_EQ(path->soft_cost, 0.0);
}

//   Behind the horizon of the search nobody is seen: straight through the one who stands there.
TEST(SoftHybridAstar, SeesOthersUntilTheHorizonOnly) {
  const Pose start{10, 25, 0};
  Scene scene(empty_map(50), {40, 25, 0});
  scene.place_other({25, 25, 1.5}, {});
  SoftProblem problem = scene.problem(start);
  EXPECT_GT(search(problem)->steps.size(), 284U);
  problem.others.horizon = 7;  // reached before the other one is
  EXPECT_EQ(search(problem)->steps.size(), 284U);
  EXPECT_EQ(search(problem)->soft_cost, 0.0);
}

//   Between two walls, one primitive ahead and one behind are too long: 0.6 m of room to turn round
//   in.
TEST(SoftHybridAstar, SlowPrimitivesLeadOutOfTightPlaces) {
  Map map = empty_map(50);
  map.polygons = {{{24.3, 20}, {25, 20}, {25, 30}, {24.3, 30}},
                  {{16, 20}, {18.9, 20}, {18.9, 30}, {16, 30}}};
  const Pose start{21.2, 25, 0};  // its body reaches from 20.2 to 23.2
  const Scene scene(map, {21.5, 40, 1.5707963});
  const SoftOptions quick{.max_expansions = 20'000, .cell = 0.5, .cell_heading = 0.1};
  EXPECT_FALSE(search(scene.problem(start), quick));
  SoftOptions slow = quick;
  slow.slowly = true;
  const std::optional<SoftResult> path = search(scene.problem(start), slow);
  ASSERT_TRUE(path);
  EXPECT_LT(distance(drive(start, path->steps), {21.5, 40, 1.5707963}), 1e-8);
  for (const Arc& step : path->steps) EXPECT_LE(std::abs(step.length), kTime.dt + 1e-9);
}

//   Head on in the open: both the soft-collision cost and the referee-like check say that nobody is
//   touched.
TEST(SoftHybridAstar, GivesWayToTheOther) {
  const Pose start{10, 25, 0};
  Scene scene(empty_map(50), {40, 25, 0});
  scene.place_other({40, 25, 3.14159265358979}, std::vector<Arc>(284, Arc{0.1059, 0.0}));
  const std::optional<SoftResult> path = search(scene.problem(start));
  ASSERT_TRUE(path);
  EXPECT_EQ(path->soft_cost, 0.0);
  const ArcTrajectory trajectory = scene.trajectory(start, *path);
  for (int t = 0; t < 400; t += kTime.macro_step) {
    EXPECT_FALSE(meet(trajectory.boxes(t), scene.shapes[0], scene.trajectories[1].boxes(t),
                      scene.shapes[1], kTime.macro_step));
  }
}

//   In a corridor there is no path past: the soft-collision cost is paid, and more of it the dearer
//   the other is.
TEST(SoftHybridAstar, DrivesThroughTheOtherWhereItMust) {
  const Pose start{5, 1.5, 0};
  Scene scene(corridor(), {45, 1.5, 0});
  scene.place_other({25, 1.5, 0}, {});
  const std::optional<SoftResult> path = search(scene.problem(start));
  ASSERT_TRUE(path);
  EXPECT_GE(path->soft_cost, 10.0);
  EXPECT_NEAR(path->cost, path->soft_cost + double(path->steps.size()) * kTime.dt, 1e-6);
}

//   Who may touch nobody finds no path along the corridor.
TEST(SoftHybridAstar, TouchesNobodyIfThatIsHard) {
  Scene scene(corridor(), {45, 1.5, 0});
  scene.place_other({25, 1.5, 0}, {});
  const SoftProblem problem = scene.problem({5, 1.5, 0});
  EXPECT_TRUE(search(problem));
  EXPECT_FALSE(search(problem, {.hard = true}));
  scene.place_other({25, 1.5, 0}, std::vector<Arc>(400, Arc{0.1059, 0.0}));
  EXPECT_TRUE(search(scene.problem({5, 1.5, 0}), {.hard = true}));
}

//   Walls beside and behind, and the other just ahead for a while: there is nothing to do but wait.
TEST(SoftHybridAstar, WaitsWhereItStands) {
  Map closed = corridor();
  closed.polygons.push_back({{-9, 0}, {3.7, 0}, {3.7, 3}, {-9, 3}});
  Scene scene(closed, {45, 1.5, 0});
  std::vector<Arc> steps(100);  // waits
  steps.insert(steps.end(), 400, Arc{0.1059, 0.0});
  scene.place_other({8.3, 1.5, 0}, steps);
  const Pose start{5, 1.5, 0};
  const std::optional<SoftResult> path = search(scene.problem(start), {.hard = true});
  ASSERT_TRUE(path);
  const ArcTrajectory trajectory = scene.trajectory(start, *path);
  for (int t = 0; t < 500; t += kTime.macro_step) {
    EXPECT_FALSE(meet(trajectory.boxes(t), scene.shapes[0], scene.trajectories[1].boxes(t),
                      scene.shapes[1], kTime.macro_step));
  }
}

//   Among others at rest a search that leaves out time says at once that there is no path, and one
//   that does not waits for ever.
TEST(SoftHybridAstar, TimeCanBeLeftOut) {
  Scene scene(corridor(), {45, 1.5, 0});
  scene.place_other({25, 1.5, 0}, {});
  const SoftProblem problem = scene.problem({5, 1.5, 0});
  const SoftOptions hard{.max_expansions = 3000, .hard = true};
  SoftOptions timeless = hard;
  timeless.leave_out_time();
  SoftHybridAstar astar(2);
  EXPECT_FALSE(astar.search(problem, timeless, Deadline::never()));
  const std::int64_t expansions = astar.expansions();
  EXPECT_LT(expansions, 20);
  EXPECT_FALSE(astar.search(problem, hard, Deadline::never()));
  EXPECT_GT(astar.expansions() - expansions, 2000);
}

//   The other drives over the goal later on: whoever rests there before pays.
TEST(SoftHybridAstar, ArrivesAfterTheLastOneHasPassed) {
  Scene scene(empty_map(50), {25, 25, 0});
  std::vector<Arc> steps(100);  // waits
  steps.insert(steps.end(), 300, Arc{0.1059, 0.0});
  scene.place_other({25, 10, 1.5707963267949}, steps);
  const std::optional<SoftResult> path =
      search(scene.problem({15, 25, 0}), {.max_expansions = 5000});
  ASSERT_TRUE(path);
  EXPECT_EQ(path->soft_cost, 0.0);
  EXPECT_GT(path->steps.size(), 100U + 150U);
}

TEST(SoftHybridAstar, KeepsTheDeadline) {
  const Pose start{10, 10, 0.3};
  const Scene scene(empty_map(50), {30, 25, 2.0});
  SoftProblem problem = scene.problem(start);
  const int shortest = int(search(problem)->steps.size());
  problem.deadline = shortest;
  EXPECT_TRUE(search(problem));
  problem.deadline = int(reeds_shepp_length(start, {30, 25, 2.0}, 3.0) / kTime.dt) - 1;
  EXPECT_FALSE(search(problem));
}

TEST(SoftHybridAstar, StaysClearOfObstaclesAndInsideTheMap) {
  Map map = empty_map(40);
  for (int k = 0; k < 12; ++k) map.circles.push_back({20.0 + (k % 3), 4.0 + 2.5 * k, 0.8});
  const Pose start{8, 20, 0};
  const Scene scene(map, {32, 20, 0});
  const std::optional<SoftResult> path = search(scene.problem(start), {.max_expansions = 20000});
  ASSERT_TRUE(path);
  Pose pose = start;
  for (const Arc& step : path->steps) {
    EXPECT_TRUE(scene.car.is_free(pose, step));
    pose = drive(pose, step);
  }
}

//   A budget without bound takes no memory by itself; what is expanded does.
TEST(SoftHybridAstar, ItsMemoryGrowsWithTheSearch) {
  const Pose start{10, 10, 0};
  const Scene open(empty_map(50), {40, 10, 0});
  SoftHybridAstar search(2);
  SoftOptions options{.max_expansions = std::numeric_limits<int>::max()};
  ASSERT_TRUE(search.search(open.problem(start), options, Deadline::never()));
  const std::size_t at_first = search.cells();
  EXPECT_LT(at_first, std::size_t{1} << 20U);

  // No path out of the box: everything inside and all the time are searched.
  Map closed = empty_map(30);
  closed.polygons = {{{20, -5}, {21, -5}, {21, 35}, {20, 35}}};
  const Scene box(closed, {26, 15, 0});
  options = {.max_expansions = 150'000, .cell = 0.5, .cell_heading = 0.1, .cell_macro_steps = 1};
  EXPECT_FALSE(search.search(box.problem({10, 15, 0}), options, Deadline::never()));
  EXPECT_GT(search.expansions(), 30'000);
  EXPECT_GT(search.cells(), at_first);
}

//   A tail: planned from a macro step on, arcs are counted from there.
TEST(SoftHybridAstar, PlansFromALaterMacroStepOn) {
  const Pose start{10, 10, 0};
  Scene scene(empty_map(50), {40, 10, 0});
  scene.place_other({25, 10, 1.5707963267949}, std::vector<Arc>(140, Arc{0.1059, 0.0}));
  SoftProblem problem = scene.problem(start);
  problem.start_macro_step = 10;  // the other has left by then
  const std::optional<SoftResult> path = search(problem);
  ASSERT_TRUE(path);
  EXPECT_EQ(path->soft_cost, 0.0);
  EXPECT_NEAR(path->cost, (140.0 + double(path->steps.size())) * kTime.dt, 1e-6);
}

}  // namespace
}  // namespace mvtp
