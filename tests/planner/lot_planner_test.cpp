#include "planner/lot/lot_planner.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "planner/lot/lot_ground.hpp"
#include "tests/planner/small_instances.hpp"

namespace mvtp {
namespace {

const Vehicle kCar{.front = 3.6, .rear = 0.9, .width = 1.8, .min_turning_radius = 4.0};

constexpr double kUp = std::numbers::pi / 2;

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

TEST(LotPlanner, GivesACarAPathToItsPlace) {
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

//   Over days, cars ask for paths to places without number.
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

constexpr Vehicle kLongCar{.front = 4.0, .rear = 1.0, .width = 1.9, .min_turning_radius = 4.5};

/// A slot of 2.6 m around `x` [m], across an aisle of 5.2 m; walls from `begin` [m] on.
ParkingLot tight_slot(double x, double begin) {
  ParkingLot lot;
  lot.id = "lot";
  lot.ground = {{0, 0}, {40, 0}, {40, 18}, {0, 18}};
  lot.obstacles = {{{begin, 0}, {x - 1.3, 0}, {x - 1.3, 5.5}, {begin, 5.5}},
                   {{x + 1.3, 0}, {40, 0}, {40, 5.5}, {x + 1.3, 5.5}},
                   {{begin, 10.7}, {40, 10.7}, {40, 18}, {begin, 18}}};
  return lot;
}

//   A lattice finds no path out between two long cars.
TEST(LotPlanner, FindsAPathOutOfATightSlot) {
  LotPlanner planner(tight_slot(20.5, 0.0), {});
  LotMotion motion;
  const Pose slot{20.5, 1.3, std::numbers::pi / 2};
  LotRequest leaving = {
      .key = 1, .body = kLongCar, .pose = slot, .goals = {{8.0, 8.0, std::numbers::pi}}};
  ASSERT_TRUE(planner.admit(motion, leaving, {}));
  EXPECT_TRUE(motion.forecast().complete);
}

//   The last metres are those that it would drive alone: among others, too, a lattice would not
//   find into the slot, and somebody stands on the path to it.
TEST(LotPlanner, GoesRoundOthersOnThePathIntoATightSlot) {
  LotPlanner planner(tight_slot(32.5, 20.0), {});
  LotMotion motion;
  const LotRequest parks = {
      .key = 1, .body = kLongCar, .pose = {3, 8, 0}, .goals = {{32.5, 1.3, kUp}}};
  const std::vector<StandingCar> somebody = {{{12, 8, 0}, {.front = 1, .rear = 1, .width = 1.8}}};
  ASSERT_TRUE(planner.admit(motion, parks, somebody));
  EXPECT_TRUE(motion.forecast().complete);
}

//   It comes down the lane at speed, to the south of the lot, and the next one stands behind it.
TEST(LotPlanner, LetsACarInFromAnEntryLaneWhileItMoves) {
  ParkingLot lot = open_ground();
  lot.ground = {{15, 15}, {40, 15}, {40, 30}, {0, 30}, {0, 15}, {10, 15}, {10, 1}, {15, 1}};
  lot.entries.push_back({"in", {12.5, 1, kUp}, 14, 0});
  LotPlanner planner(lot, {});
  LotMotion motion;
  LotRequest coming = request(1, {12.5, 4, kUp}, {30, 22, 0});
  coming.entry = 0;
  coming.speed = 2.5;
  ASSERT_TRUE(planner.admit(motion, coming, {}));
  const LotCar& car = motion.cars().front();
  EXPECT_TRUE(motion.forecast().complete);
  for (double s = 0.0; s <= planner.prefix_length(2.5); s += 0.5) {
    EXPECT_NEAR(car.path.at(s).x, 12.5, 1e-6) << "it cannot turn before it could brake";
  }
}

//   <...   A lorry stands in the lane, with a wall to its west. Who goes round it by the east, and
//     |#:  then to the west, comes back into the lane if that is so long.
//     |^:
TEST(LotPlanner, LetsNobodyComeBackIntoItsEntryLane) {
  const auto admits = [](double lane_to) {
    ParkingLot lot = open_ground();
    lot.obstacles = {{{18, 0}, {18.5, 0}, {18.5, 13}, {18, 13}}};
    lot.entries.push_back({"in", {20, 1, kUp}, lane_to - 1.0, 0});
    LotPlanner planner(lot, {});
    LotMotion motion;
    LotRequest coming = request(1, {20, 2, kUp}, {6, 20, 2 * kUp});
    coming.entry = 0;
    const std::vector<StandingCar> lorry = {
        {{20, 11, kUp}, {.front = 2.0, .rear = 0.5, .width = 2.6}}};
    return planner.admit(motion, coming, lorry).has_value();
  };
  EXPECT_FALSE(admits(26.0));
  EXPECT_TRUE(admits(10.0));
}

/// A lane out to the east at the height of the middle.
ParkingLot with_exit() {
  ParkingLot lot = open_ground();
  lot.exits.push_back({"out", {30, 15, 0}, 10, 0});
  return lot;
}

LotRequest leaving(std::int64_t key, const Pose& from, double along) {
  LotRequest result = request(key, from, {30 + along, 15, 0});
  result.leaves = true;
  return result;
}

TEST(LotPlanner, LetsCarsLeaveOneBehindTheOther) {
  LotPlanner planner(with_exit(), {});
  LotMotion motion;
  ASSERT_TRUE(planner.admit(motion, leaving(1, {5, 5, 0}, 3.0), {}));
  ASSERT_TRUE(planner.admit(motion, leaving(2, {5, 25, 0}, 3.0), {}));
  EXPECT_TRUE(motion.forecast().complete);
}

TEST(LotGround, AStripIsAsLongAsItsPartOfTheLane) {
  const Polygon corners = strip({"in", {10, 5, kUp}, 20, 0}, 2.0, 12.0);
  ASSERT_EQ(corners.size(), 4U);
  for (const Point& p : corners) {
    EXPECT_NEAR(std::abs(p.x - 10.0), 1.2, 1e-9);
    EXPECT_NEAR(std::abs(p.y - 12.0), 5.0, 1e-9);
  }
}

//   Two that do not meet lose nothing: there is nothing to look for.
TEST(LotPlanner, WhoLosesNothingKeepsItsPlan) {
  LotPlanner planner(open_ground(), {});
  LotMotion motion;
  ASSERT_TRUE(planner.admit(motion, request(1, {5, 5, 0}, {30, 5, 0}), {}));
  ASSERT_TRUE(planner.admit(motion, request(2, {5, 25, 0}, {30, 25, 0}), {}));
  EXPECT_EQ(planner.decide(motion, {}), 0);
  EXPECT_EQ(planner.failures_kept(), 0U);
}

/// Two rows of five change sides, each car to the place of a random one of the other row, which
/// stands 4 m further on by then.
LotMotion crowd(LotPlanner& planner, Dice& dice, int* replanned = nullptr) {
  LotMotion motion;
  std::vector<LotRequest> requests;
  for (const bool up : {true, false}) {
    std::vector<double> places = {5, 12, 19, 26, 33};
    for (int k = 0; k < 5; ++k) {
      const auto other = places.begin() + dice.below(int(places.size()));
      const double x = 5.0 + 7.0 * k;
      requests.push_back(up ? request(k, {x, 3, kUp}, {*other, 19, kUp})
                            : request(5 + k, {x, 27, -kUp}, {*other, 11, -kUp}));
      places.erase(other);
    }
  }
  for (std::size_t k = 0; k < requests.size(); ++k) {
    std::vector<StandingCar> standing;
    for (std::size_t j = k + 1; j < requests.size(); ++j) {
      standing.push_back({requests[j].pose, kCar});
    }
    const auto admission = planner.admit(motion, requests[k], standing);
    if (admission && replanned != nullptr) *replanned += admission->replanned;
  }
  return motion;
}

TEST(LotPlanner, WhoWouldWaitLongGoesBeforeOthersIfGroupsArePlanned) {
  for (const bool regroup : {false, true}) {
    LotPlannerOptions options;
    options.regroup = regroup;
    Dice dice(11);
    int replanned = 0;
    for (int scene = 0; scene < 3; ++scene) {
      LotPlanner planner(open_ground(), options);
      EXPECT_TRUE(crowd(planner, dice, &replanned).forecast().complete);
    }
    if (regroup) {
      EXPECT_GT(replanned, 0);
    } else {
      EXPECT_EQ(replanned, 0);
    }
  }
}

//   Far from all others, one more changes nothing for them.
TEST(LotPlanner, CarsThatKeepTheirPathsKeepTheirOrder) {
  ParkingLot wide = open_ground();
  wide.ground = {{0, 0}, {80, 0}, {80, 30}, {0, 30}};
  Dice dice(11);
  for (int scene = 0; scene < 4; ++scene) {
    LotPlanner planner(wide, {});
    LotMotion motion = crowd(planner, dice);
    for (int second = 1; second < 10; ++second) {
      for (int step = 0; step < 10; ++step) {
        motion.step(0.1, std::vector<double>(motion.cars().size(), 1e9));
      }
      LotMotion with_another = motion;
      ASSERT_TRUE(planner.admit(with_another, request(99, {50, 15, 0}, {70, 15, 0}), {}));
      LotForecast after = with_another.forecast();
      after.driven.pop_back();
      EXPECT_EQ(after.driven, motion.forecast().driven) << scene << ", " << second << " s";
    }
  }
}

/// Wherever the two meet, `first` passes before `second`.
void let_pass(LotMotion& motion, std::int64_t first, std::int64_t second) {
  const LotCar& a = motion.cars()[std::size_t(motion.find(first))];
  const LotCar& b = motion.cars()[std::size_t(motion.find(second))];
  std::vector<float> early(std::size_t(a.cells.size()));
  std::vector<float> late(std::size_t(b.cells.size()));
  for (std::size_t c = 0; c < early.size(); ++c) early[c] = float(c);
  for (std::size_t c = 0; c < late.size(); ++c) late[c] = float(early.size() + c);
  late[0] = -1.0F;  // where it is
  auto [order, other] = precedence({&a.cells, 0, early}, {&b.cells, 0, late});
  motion.set_order(first, second, std::move(order));
  motion.set_order(second, first, std::move(other));
}

//       : 2     Car 1 waits for long until car 2, which is far, has passed. Car 3 does not wait for
//   1 --=.....  it, but goes round behind it.
//      ^:
//      3
TEST(LotPlanner, PathsLeadRoundThoseThatWait) {
  ParkingLot lot = open_ground();
  lot.ground = {{0, 0}, {40, 0}, {40, 60}, {0, 60}};
  LotPlannerOptions options;
  options.regroup = false;
  LotPlanner planner(lot, options);
  LotMotion motion;
  ASSERT_TRUE(planner.admit(motion, request(1, {11, 15, 0}, {35, 15, 0}), {}));
  ASSERT_TRUE(planner.admit(motion, request(2, {20, 56, -kUp}, {20, 8, -kUp}), {}));
  let_pass(motion, 2, 1);
  ASSERT_TRUE(planner.admit(motion, request(3, {16.5, 3, kUp}, {16.5, 38, kUp}), {}));
  const LotForecast forecast = motion.forecast();
  EXPECT_LT(forecast.arrival(2), forecast.arrival(1));
  EXPECT_LT(forecast.arrival(1), forecast.arrival(0));
}

//   Plans change under way, but only for better ones that are complete as well.
TEST(LotPlanner, ADecisionOnlyMakesThePlanBetter) {
  Dice dice(11);
  int improved = 0;
  for (int scene = 0; scene < 6; ++scene) {
    LotPlanner planner(open_ground(), {});
    LotMotion motion = crowd(planner, dice);
    for (int decision = 0; decision < 40 && !motion.cars().empty(); ++decision) {
      const double before = motion.forecast().cost();
      if (planner.decide(motion, {}) > 0) {
        ++improved;
        EXPECT_LT(motion.forecast().cost(), before - 0.4);
      }
      EXPECT_TRUE(motion.forecast().complete);
      for (int step = 0; step < 5; ++step) {
        motion.step(0.1, std::vector<double>(motion.cars().size(), 1e9));
      }
      for (int key = 0; key < 10; ++key) {
        const int i = motion.find(key);
        if (i >= 0 && motion.cars()[std::size_t(i)].at_end()) motion.remove(key);
      }
    }
  }
  EXPECT_GT(improved, 0);
}

/// PBCR: nobody has a complete plan.
class LotPbcr : public testing::Test {
 protected:
  LotPbcr() {
    LotPlannerOptions options;
    options.plans_groups = false;
    planner_.emplace(lot_, options);
  }

  [[nodiscard]] bool admit(std::int64_t key, const Pose& from, const Pose& to,
                           std::span<const StandingCar> standing = {}) {
    return planner_->admit(motion_, request(key, from, to), standing).has_value();
  }
  [[nodiscard]] const LotCar& car(std::int64_t key) const {
    return motion_.cars()[std::size_t(motion_.find(key))];
  }
  /// Who has arrived stays where it is.
  void drive(double seconds, std::span<const StandingCar> standing = {}) {
    for (int step = 0; step < int(seconds * 10); ++step) {
      if (step % 5 == 0) (void)planner_->decide(motion_, standing);
      const std::vector<double> stopping_points(motion_.cars().size(), 1e9);
      motion_.step(0.1, stopping_points);
    }
  }

  ParkingLot lot_ = open_ground();
  std::optional<LotPlanner> planner_;
  LotMotion motion_;
};

//       2
//       :          2 has the smaller key, but 7 has been under way for longer
//   7 ..:.....>
//       v
TEST_F(LotPbcr, WhoGotUnderWayEarlierPassesFirst) {
  ASSERT_TRUE(admit(7, {5, 15, 0}, {34, 15, 0}));
  ASSERT_TRUE(admit(2, {20, 25, -kUp}, {20, 5, -kUp}));
  double passed = 0.0;
  while (car(2).s < 12.0 && passed < 60.0) {
    drive(0.5);
    passed += 0.5;
    if (car(2).pose().y - kCar.front < 16.0) {
      EXPECT_GT(car(7).pose().x, 21.0);
    }
  }
  EXPECT_LT(passed, 60.0);
}

//   7 goes past 2, which stands on its path and has to go through where 7 is.
TEST_F(LotPbcr, WhoWouldComeToRestOnThePathOfAnEarlierOneStaysWhereItIs) {
  ASSERT_TRUE(admit(7, {5, 15, 0}, {34, 15, 0}));
  EXPECT_FALSE(admit(2, {20, 13.2, kUp}, {20, 25, kUp}));
  drive(8.0);
  EXPECT_TRUE(admit(2, {20, 13.2, kUp}, {20, 25, kUp})) << "when it is past";
}

//   Those who stand 0.25 m beside the path, inside a bend, hold nobody up; one on it does.
TEST_F(LotPbcr, PassesCloselyWhoStands) {
  ASSERT_TRUE(admit(7, {5, 5, 0}, {20, 20, kUp}));
  std::vector<StandingCar> standing;
  const LotCar path = car(7);
  for (double s = 6.0; s < path.path.length() - 6.0; s += 2.5) {
    const Pose beside = compose(path.path.at(s), {0.0, 0.9 + 0.25 + 0.9, 0.0});
    standing.push_back({beside, {.front = 0.9, .rear = 0.9, .width = 1.8}});
  }
  drive(40.0, standing);
  EXPECT_TRUE(car(7).at_end());

  ASSERT_TRUE(admit(8, {25, 5, 0}, {35, 5, 0}));
  const std::vector<StandingCar> on_it = {{{34, 5, 0}, {.front = 0.9, .rear = 0.9, .width = 1.8}}};
  drive(40.0, on_it);
  EXPECT_FALSE(car(8).at_end());
  EXPECT_LT(car(8).pose().x + kCar.front, 33.1);
  EXPECT_GT(car(8).pose().x + kCar.front, 32.0);
}

//   From rest it could stop on the footpath before it is over it.
TEST_F(LotPbcr, CrossesAFootpathWithoutAStop) {
  lot_.footpaths = {{{{15, 0}, {15, 30}}, 2.0}};
  LotPlannerOptions options;
  options.plans_groups = false;
  planner_.emplace(lot_, options);
  ASSERT_TRUE(admit(7, {5, 15, 0}, {34, 15, 0}));
  for (double time = 0.0; time < 40.0; time += 0.1) {
    drive(0.1);
    const double front = car(7).pose().x + kCar.front;
    const bool on_it = front > 14.0 && front - kCar.length() < 16.0;
    if (on_it) {
      EXPECT_GT(car(7).v, 0.0);
    }
  }
  EXPECT_TRUE(car(7).at_end());
}

}  // namespace
}  // namespace mvtp
