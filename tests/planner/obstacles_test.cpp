#include "planner/motion/obstacles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "planner/geometry/polygon.hpp"
#include "planner/motion/cost_to_go.hpp"
#include "planner/motion/grid_distance.hpp"
#include "planner/motion/stepped_car.hpp"
#include "tests/planner/fcl_reference.hpp"

namespace mvtp {
namespace {

const Vehicle kCar;

Map random_map(unsigned seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> place(0, 30);
  std::uniform_real_distribution<double> size(0.2, 2.0);
  Map map{.width = 30, .height = 30, .circles = {}, .polygons = {}};
  for (int k = 0; k < 15; ++k) map.circles.push_back({place(rng), place(rng), size(rng)});
  for (int k = 0; k < 8; ++k) {
    const double x = place(rng);
    const double y = place(rng);
    // An arrow head: not convex.
    const double s = 2 * size(rng);
    map.polygons.push_back({{x, y}, {x + s, y + s}, {x, y + 2 * s}, {x + s / 2, y + s}});
  }
  return map;
}

/// Does a box, sampled as points, lie on an obstacle? Sampling may miss a sliver.
bool covers(const Map& map, const OrientedBox& box) {
  for (int a = -10; a <= 10; ++a) {
    for (int b = -10; b <= 10; ++b) {
      const double along = box.half_length * a / 10.0;
      const double across = box.half_width * b / 10.0;
      const Point p{box.x + along * box.ux - across * box.uy,
                    box.y + along * box.uy + across * box.ux};
      for (const Circle& c : map.circles) {
        if (std::hypot(p.x - c.x, p.y - c.y) < c.radius - 1e-3) return true;
      }
      for (const Polygon& polygon : map.polygons) {
        if (contains(polygon, p)) return true;
      }
    }
  }
  return false;
}

TEST(Obstacles, FindsEveryObstacleThatADenseSampleFinds) {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> place(-1, 31);
  std::uniform_real_distribution<double> unit(-1, 1);
  int hits = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    const Map map = random_map(seed);
    const Obstacles obstacles(map, 4.0);
    for (int k = 0; k < 100; ++k) {
      const Sweep sweep(kCar, {place(rng), place(rng), 3 * unit(rng)},
                        {2 * unit(rng), 0.4 * unit(rng)});
      bool covered = false;
      for (int s = 0; s <= 10; ++s) covered = covered || covers(map, sweep.at(s / 10.0));
      if (covered) {
        EXPECT_TRUE(obstacles.hit(sweep));
      }
      hits += covered ? 1 : 0;
    }
  }
  EXPECT_GT(hits, 200);
  EXPECT_LT(hits, 900);
}

//   With a fifth corner on one of its sides it is the same place, but no longer a rectangle.
TEST(Obstacles, ARectangleIsThePolygonThatItIs) {
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> unit(0, 1);
  int hits = 0;
  for (int k = 0; k < 3000; ++k) {
    const OrientedBox box = footprint(
        {.front = 1 + 3 * unit(rng), .rear = 1, .width = 0.5 + unit(rng)}, {15, 15, 7 * unit(rng)});
    Polygon rectangle;
    for (const auto& [a, b] : {std::pair{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}) {
      const double along = a * box.half_length;
      const double across = b * box.half_width;
      rectangle.push_back(
          {box.x + along * box.ux - across * box.uy, box.y + along * box.uy + across * box.ux});
    }
    Polygon pentagon = rectangle;
    pentagon.push_back(
        {(rectangle[0].x + rectangle[3].x) / 2, (rectangle[0].y + rectangle[3].y) / 2});
    const Obstacles boxes(Map{.width = 30, .height = 30, .circles = {}, .polygons = {rectangle}},
                          4.0);
    const Obstacles edges(Map{.width = 30, .height = 30, .circles = {}, .polygons = {pentagon}},
                          4.0);
    const Sweep sweep(kCar, {11 + 8 * unit(rng), 11 + 8 * unit(rng), 7 * unit(rng)},
                      {4 * unit(rng) - 2, 0.8 * unit(rng) - 0.4});
    EXPECT_EQ(boxes.first_hit(sweep), edges.first_hit(sweep));
    hits += boxes.hit(sweep) ? 1 : 0;
  }
  EXPECT_GT(hits, 600);
  EXPECT_LT(hits, 2700);
}

TEST(Obstacles, ReportsNothingThatIsNotThere) {
  std::mt19937_64 rng(4);
  std::uniform_real_distribution<double> place(0, 30);
  const Map map = random_map(11);
  const Obstacles obstacles(map, 4.0);
  for (int k = 0; k < 500; ++k) {
    const Pose pose{place(rng), place(rng), place(rng)};
    const OrientedBox box = footprint(kCar, pose);
    const int found = obstacles.first_hit(Sweep(kCar, pose, {}));
    if (found < 0) continue;
    if (found < int(map.circles.size())) {
      const Circle& c = map.circles[std::size_t(found)];
      EXPECT_TRUE(fcl_overlap(box, {c.x, c.y}, c.radius));
      continue;
    }
    const Polygon& polygon = map.polygons[std::size_t(found) - map.circles.size()];
    bool touches = contains(polygon, {box.x, box.y});
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      OrientedBox edge = segment(polygon[i], polygon[(i + 1) % polygon.size()]);
      edge.half_width = 1e-6;  // FCL wants bodies
      touches = touches || fcl_overlap(box, edge);
    }
    EXPECT_TRUE(touches);
  }
}

TEST(Obstacles, ASweepLongerThanTheGridIsMadeForIsStillSeen) {
  const Map map{.width = 100, .height = 10, .circles = {{90, 5, 1}}, .polygons = {}};
  EXPECT_TRUE(Obstacles(map, 2.0).hit(Sweep(kCar, {5, 5, 0}, {90, 0})));
  EXPECT_FALSE(Obstacles(map, 2.0).hit(Sweep(kCar, {5, 5, 0}, {70, 0})));
}

//   A car that stands wholly inside a large block touches none of its edges.
TEST(Obstacles, APolygonIsSolid) {
  const Map map{
      .width = 30, .height = 30, .circles = {}, .polygons = {{{5, 5}, {25, 5}, {25, 25}, {5, 25}}}};
  EXPECT_TRUE(Obstacles(map, 4.0).hit(Sweep(kCar, {15, 15, 0}, {})));
}

/// A wall across a room of 20 x 20 m with a gap of `gap` metres at the top.
Map room_with_wall(double gap) {
  return {.width = 20,
          .height = 20,
          .circles = {},
          .polygons = {{{9.5, 0}, {10.5, 0}, {10.5, 20 - gap}, {9.5, 20 - gap}}}};
}

TEST(GridDistance, GoesRoundAWall) {
  const auto grid = std::make_shared<ObstacleGrid>(room_with_wall(4), 0.8);
  const GridDistance distance(grid, {15, 3});
  EXPECT_NEAR(distance.at(15, 10), 7.0, 1.0);
  EXPECT_GT(distance.at(5, 3), 28.0);  // up to the gap and down again
  EXPECT_LT(distance.at(5, 3), 36.0);
}

TEST(GridDistance, KnowsThatAGapIsTooNarrow) {
  const auto grid = std::make_shared<ObstacleGrid>(room_with_wall(1), 0.8);
  EXPECT_TRUE(std::isinf(GridDistance(grid, {15, 3}).at(5, 3)));
}

TEST(GridDistance, IsTheStraightLineOnAnEmptyMapWithinThreePercent) {
  const auto grid = std::make_shared<ObstacleGrid>(
      Map{.width = 40, .height = 40, .circles = {}, .polygons = {}}, 0.8);
  const GridDistance distance(grid, {20.5, 20.5});
  for (double x = 0.5; x < 40; ++x) {
    for (double y = 0.5; y < 40; ++y) {
      const double straight = std::hypot(x - 20.5, y - 20.5);
      EXPECT_GE(distance.at(x, y), straight - 1e-3);
      EXPECT_LE(distance.at(x, y), 1.028 * straight + 1e-3);
    }
  }
}

TEST(CostToGo, IsTheLargerOfCurveAndPathAroundObstacles) {
  const Map map = room_with_wall(4);
  const ReedsShepp curves;
  const ReedsSheppTable table;
  const Pose goal{15, 3, 0};
  const CostToGo open(goal, 2.375, table, nullptr);
  const CostToGo walled(goal, 2.375, table, std::make_shared<ObstacleGrid>(map, 0.8));
  EXPECT_NEAR(open({5, 3, 0}), 10.0, 0.05);
  EXPECT_GT(walled({5, 3, 0}), 28.0);
  const Pose close{15, 4, 1.0};
  EXPECT_NEAR(walled(close), curves.length(close, goal, 2.375), 0.3);
}

class Stepped : public testing::Test {
 protected:
  const Map map_{
      .width = 20, .height = 20, .circles = {}, .polygons = {}, .bounds = Bounds::kFootprint};
  const Obstacles obstacles_{map_, 4.0};
  const SteppedCar car_{kCar, 1.0, CollisionRule::kContinuous, map_, obstacles_};
};

TEST_F(Stepped, CutsAPathIntoStepsThatLeadToTheSamePose) {
  const std::vector<Arc> path = {{2.5, 0.4}, {-1.0, 0.0}, {0.3, -0.4}, {3.0, 0.0}};
  const std::vector<Arc> steps = car_.steps(path);
  EXPECT_EQ(steps.size(), 3U + 1U + 1U + 3U);
  const Pose from{5, 5, 1};
  EXPECT_LT(distance(drive(from, steps), drive(from, path)), 1e-9);
  for (const Arc& step : steps) EXPECT_LE(std::abs(step.length), 1.0);
}

TEST_F(Stepped, KeepsTheWholeBodyInsideTheMap) {
  EXPECT_TRUE(car_.in_bounds({17.0, 10, 0}, {}));
  EXPECT_FALSE(car_.in_bounds({17.6, 10, 0}, {}));  // the nose is 2.5 m ahead
  EXPECT_FALSE(car_.in_bounds({17.0, 10, 0}, {1, 0}));
  EXPECT_TRUE(car_.in_bounds({17.0, 10, 0}, {-1, 0}));
}

//   Both ends of this turn are inside; its outermost point is not.
TEST_F(Stepped, SeesABodyLeaveTheMapInTheMiddleOfAnArc) {
  const Pose from{10, 17.36, 0.9};
  const Arc arc{4.5, -0.4};
  ASSERT_TRUE(car_.in_bounds(from, {}));
  ASSERT_TRUE(car_.in_bounds(drive(from, arc), {}));
  EXPECT_FALSE(car_.in_bounds(from, arc));
}

TEST_F(Stepped, UnderTheRuleOfStepsOnlyTheEndsCount) {
  Map map = map_;
  map.circles = {{10, 10, 0.5}};
  const Obstacles obstacles(map, 8.0);
  const Pose from{5, 10, 0};
  const Arc over_it{10, 0};
  const SteppedCar strict(kCar, 10.0, CollisionRule::kContinuous, map, obstacles);
  const SteppedCar lax(kCar, 10.0, CollisionRule::kSteps, map, obstacles);
  EXPECT_FALSE(strict.is_free(from, over_it));
  EXPECT_TRUE(lax.is_free(from, over_it));
  EXPECT_FALSE(lax.is_free(from, {4, 0}));
}

}  // namespace
}  // namespace mvtp
