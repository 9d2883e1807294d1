#include "coordinator/network/drivable_area.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "coordinator/audit/audit.hpp"
#include "planner/problem/interruption.hpp"
#include "tests/coordinator/fake_traffic.hpp"

namespace mvtp {
namespace {

/// A road of two lanes that bends, of 3.2 m each, whose middles are `apart` metres apart.
RoadNetwork two_lanes(double apart) {
  RoadNetwork network;
  for (const int i : {0, 1}) {
    const double y = apart * i;
    Lane lane{.id = "e_" + std::to_string(i), .edge = "e", .index = i, .length = 100.0};
    lane.shape = {{0.0, y}, {50.0, y}, {100.0, y + 20.0}};
    network.lanes.emplace(lane.id, lane);
    network.edges["e"].push_back(lane.id);
  }
  return network;
}

/// Does a car that comes over from the one lane into the other leave the road?
bool leaves_the_road(const RoadNetwork& network, double apart) {
  const DrivableArea area(network);
  const Vehicle car = fake_type("car").body;
  for (double x = 5.0; x < 45.0; x += 0.01) {
    const Pose pose{x, apart * (x - 5.0) / 40.0, std::atan2(apart, 40.0)};
    if (area.share_outside(pose, car, Audit::kRoadTolerance) > 0.0) return true;
  }
  return false;
}

// netconvert puts a line of 0.1 m between lanes, and rounds to a hundredth.
TEST(DrivableArea, SeamsBetweenLanesAreRoad) {
  EXPECT_FALSE(leaves_the_road(two_lanes(3.2), 3.2));
  EXPECT_FALSE(leaves_the_road(two_lanes(3.31), 3.31));
  EXPECT_FALSE(leaves_the_road(two_lanes(3.6), 3.6));
}

TEST(DrivableArea, WhatLiesBetweenLanesFarApartIsNot) {
  EXPECT_TRUE(leaves_the_road(two_lanes(4.5), 4.5));
}

TEST(DrivableArea, TheSeamFollowsABend) {
  const DrivableArea area(two_lanes(3.4));
  EXPECT_TRUE(area.contains({75.0, 10.0 + 1.7}, 0.0));
  EXPECT_TRUE(area.contains({50.0, 1.7}, 0.0));
  EXPECT_FALSE(area.contains({25.0, 5.1}, 0.0)) << "beside the road";
}

TEST(DrivableArea, GroundToKeepOffTouchesNoBody) {
  DrivableArea area(two_lanes(3.2));
  const Vehicle car{.front = 3.6, .rear = 1.4, .width = 1.8};
  const Pose pose{20.0, 0.0, 0.0};
  EXPECT_EQ(area.share_outside(pose, car, 0.0), 0.0);
  area.keep_off({{22.0, -1.6}, {23.0, -1.6}, {23.0, -0.91}, {22.0, -0.91}});
  EXPECT_EQ(area.share_outside(pose, car, 0.0), 0.0) << "beside the body";
  area.keep_off({{22.0, -1.6}, {23.0, -1.6}, {23.0, -0.89}, {22.0, -0.89}});
  EXPECT_EQ(area.share_outside(pose, car, 0.0), 1.0);
}

/// One lane of 3.2 m straight to the north-east.
RoadNetwork diagonal(double length) {
  RoadNetwork network;
  const double side = length / std::numbers::sqrt2;
  Lane lane{.id = "e_0", .edge = "e", .length = length};
  lane.shape = {{0.0, 0.0}, {side, side}};
  network.lanes.emplace(lane.id, lane);
  network.edges["e"].push_back(lane.id);
  return network;
}

TEST(DrivableArea, TakesMemoryByTheMetreOfARoad) {
  const std::size_t short_road = DrivableArea(diagonal(2'000.0)).entries();
  const std::size_t long_road = DrivableArea(diagonal(20'000.0)).entries();
  EXPECT_LT(short_road, 2'000U);  // cells of 8 m, and those beside them
  EXPECT_LT(long_road, 10.1 * double(short_road));
}

TEST(DrivableArea, ALongRoadIsFoundWhereverItIs) {
  const DrivableArea area(diagonal(20'000.0));
  std::mt19937_64 random(3);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * double(random() >> 11) * 0x1p-53;
  };
  for (int i = 0; i < 20'000; ++i) {
    const double along = uniform(0.0, 20'000.0);
    const double aside = uniform(-4.0, 4.0);
    const double tolerance = uniform(0.0, 1.0);
    const double beyond = std::abs(aside) - 1.6 - tolerance;
    if (std::abs(beyond) < 1e-6) continue;
    const Point p{(along - aside) / std::numbers::sqrt2, (along + aside) / std::numbers::sqrt2};
    EXPECT_EQ(area.contains(p, tolerance), beyond < 0.0) << along << ' ' << aside;
  }
}

TEST(DrivableArea, IsMadeLaneByLaneAndCanBeGivenUp) {
  int calls = 0;
  const auto give_up = [&] {
    if (++calls == 2) throw Interruption();
  };
  EXPECT_THROW(DrivableArea(two_lanes(3.2), {}, "", give_up), Interruption);
  EXPECT_EQ(calls, 2);
}

}  // namespace
}  // namespace mvtp
