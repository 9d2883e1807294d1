#include "planner/lot/lot_planner.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace mvtp {
namespace {

const Vehicle kCar{.front = 3.6, .rear = 0.9, .width = 1.8, .min_turning_radius = 4.0};

/// 40 x 30 m of ground with nothing on it.
ParkingLot open_ground() {
  ParkingLot lot;
  lot.id = "lot";
  lot.ground = {{0, 0}, {40, 0}, {40, 30}, {0, 30}};
  return lot;
}

LotRequest request(std::int64_t key, const Pose& from, const Pose& to) {
  return {.key = key, .body = kCar, .pose = from, .speed = 0.0, .goals = {to}};
}

TEST(LotPlanner, GivesACarAWayToItsPlace) {
  LotPlanner planner(open_ground(), {});
  LotMotion motion;
  const auto request_planner = planner.admit(motion, request(1, {5, 5, 0}, {30, 20, 0}), {});
  ASSERT_TRUE(request_planner);
  ASSERT_EQ(motion.cars().size(), 1U);
  const LotCar& car = motion.cars().front();
  const Pose end = car.path.at(car.path.length());
  EXPECT_NEAR(end.x, 30.0, 1e-6);
  EXPECT_NEAR(end.y, 20.0, 1e-6);
  EXPECT_TRUE(motion.forecast().complete);
}

//   Over days, cars ask for ways to places without number.
TEST(LotPlanner, ForgetsPlacesThatNobodyAsksForAnyMore) {
  LotPlanner planner(open_ground(), {});
  const Pose from{5, 5, 0};
  const double first = planner.distance(kCar, from, {30, 20, 0});
  for (int n = 0; n < 3000; ++n) {
    (void)planner.distance(kCar, from, {10 + 0.005 * n, 20, 0});
    if (n % 10 != 9) continue;
    LotMotion motion;
    (void)planner.admit(motion, request(1, from, {12, 5, 0}), {});
    EXPECT_LE(planner.costs_kept(), LotPlanner::kMostCosts + 10);
  }
  EXPECT_EQ(planner.distance(kCar, from, {30, 20, 0}), first);
}

//   Cars that only stand there drive nowhere: they need no cost-to-go.
TEST(LotPlanner, KeepsNothingForThoseWhoWait) {
  LotPlanner planner(open_ground(), {});
  std::vector<StandingCar> waiting;
  for (int n = 0; n < 6; ++n) waiting.push_back({{6.0 * n + 3, 25, 1.57}, kCar});
  LotMotion motion;
  ASSERT_TRUE(planner.admit(motion, request(1, {5, 5, 0}, {30, 5, 0}), waiting));
  const std::size_t goals_and_tails = planner.costs_kept();
  EXPECT_LE(goals_and_tails, 2U);
}

//   A lattice finds no path out between two long cars, across an aisle of 5.2 m.
TEST(LotPlanner, FindsAWayOutOfATightSlot) {
  const Vehicle long_car{.front = 4.0, .rear = 1.0, .width = 1.9, .min_turning_radius = 4.5};
  ParkingLot lot;
  lot.id = "lot";
  lot.ground = {{0, 0}, {40, 0}, {40, 18}, {0, 18}};
  lot.obstacles = {{{0, 0}, {19.2, 0}, {19.2, 5.5}, {0, 5.5}},
                   {{21.8, 0}, {40, 0}, {40, 5.5}, {21.8, 5.5}},
                   {{0, 10.7}, {40, 10.7}, {40, 18}, {0, 18}}};
  LotPlanner planner(lot, {});
  LotMotion motion;
  const Pose slot{20.5, 1.3, std::numbers::pi / 2};
  LotRequest leaving = {
      .key = 1, .body = long_car, .pose = slot, .goals = {{8.0, 8.0, std::numbers::pi}}};
  ASSERT_TRUE(planner.admit(motion, leaving, {}));
  EXPECT_TRUE(motion.forecast().complete);
}

}  // namespace
}  // namespace mvtp
