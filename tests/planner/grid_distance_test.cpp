#include "planner/motion/grid_distance.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace mvtp {
namespace {

std::shared_ptr<const ObstacleGrid> grid_over(const Map& map) {
  return std::make_shared<ObstacleGrid>(map, 0.8);
}

TEST(GridDistance, IsTheMetricOfSixteenMovesWithoutObstacles) {
  const GridDistance distance(grid_over({.width = 40, .height = 30}), {10.5, 10.5});
  const auto from = [&](double dx, double dy) { return distance.at(10.5 + dx, 10.5 + dy); };
  EXPECT_NEAR(from(0, 0), 0.0, 1e-6);
  EXPECT_NEAR(from(7, 0), 7.0, 1e-4);
  EXPECT_NEAR(from(-5, 5), 5 * std::sqrt(2.0), 1e-4);
  EXPECT_NEAR(from(8, 4), 4 * std::sqrt(5.0), 1e-4);
  EXPECT_NEAR(from(9, 4), 4 * std::sqrt(5.0) + 1, 1e-4);
}

//   A wall with a gap at its upper end: the path leads around.
TEST(GridDistance, LeadsAroundAWall) {
  const Map map{.width = 20, .height = 20, .polygons = {{{9, 0}, {11, 0}, {11, 15}, {9, 15}}}};
  const GridDistance distance(grid_over(map), {15.5, 2.5});
  EXPECT_GT(distance.at(4.5, 2.5), 2 * 14.0);
  EXPECT_LT(distance.at(4.5, 2.5), 40.0);
  EXPECT_NEAR(distance.at(15.5, 12.5), 10.0, 1e-4);
}

TEST(GridDistance, IsInfiniteWhereNoPathLeads) {
  const Map map{.width = 20, .height = 20, .polygons = {{{9, 0}, {11, 0}, {11, 20}, {9, 20}}}};
  EXPECT_TRUE(std::isinf(GridDistance(grid_over(map), {15.5, 2.5}).at(4.5, 2.5)));
}

TEST(GridDistance, TheBorderBelongsToTheMap) {
  const GridDistance distance(grid_over({.width = 40, .height = 30}), {40.0, 30.0});
  EXPECT_NEAR(distance.at(30.5, 29.5), 9.0, 1e-4);
  EXPECT_NEAR(distance.at(40.0, 20.5), 9.0, 1e-4);
}

}  // namespace
}  // namespace mvtp
