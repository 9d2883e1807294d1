#include "traci_bridge/tail_lanes.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace mvtp {
namespace {

/// On how many of the lanes behind there is something of a tail.
std::size_t lanes_below(double tail, const std::vector<double>& before) {
  std::size_t n = 0;
  for (double covered = 0.0; n < before.size() && covered < tail; ++n) covered += before[n];
  return n;
}

TEST(TailLanes, ATailLeavesAtMostOneLaneInAStep) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  int moved = 0;
  for (int i = 0; i < 100'000; ++i) {
    std::vector<double> before;
    for (int n = 0; n < 12; ++n) before.push_back(0.1 + 2.0 * share(random) * share(random));
    before.push_back(100.0);
    const double length = 2.0 + 16.0 * share(random);
    const double lane_length = 0.2 + 20.0 * share(random);
    const double position = lane_length * share(random);
    const double step = 4.0 * share(random);
    const double to = where_tail_is_found(position, length, step, lane_length, before);
    const double then = std::min(position + step, lane_length);
    ASSERT_GE(to, position);
    ASSERT_LE(to, then + 2e-3);
    ASSERT_LE(lanes_below(length - to, before), lanes_below(length - then, before) + 1);
    moved += int(to > position);
  }
  EXPECT_GT(moved, 1000);
}

TEST(TailLanes, NobodyIsMovedWhoseTailLeavesNoneOrOne) {
  const std::vector<double> before = {0.4, 50.0};
  EXPECT_EQ(where_tail_is_found(3.0, 5.0, 0.5, 80.0, before), 3.0);    // still on both
  EXPECT_EQ(where_tail_is_found(4.5, 5.0, 0.3, 80.0, before), 4.5);    // leaves the second
  EXPECT_EQ(where_tail_is_found(60.0, 5.0, 1.4, 80.0, before), 60.0);  // left both before
}

TEST(TailLanes, WhoLeavesTwoIsPutToTheEndOfTheSecond) {
  const std::vector<double> before = {0.4, 50.0};
  EXPECT_NEAR(where_tail_is_found(4.5, 5.0, 0.6, 80.0, before), 4.6, 2e-3);
}

TEST(TailLanes, WhereTheRoadsBeginThereIsNothingToLeave) {
  EXPECT_EQ(where_tail_is_found(4.5, 5.0, 0.6, 80.0, {}), 4.5);
}

}  // namespace
}  // namespace mvtp
