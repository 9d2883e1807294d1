#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "planner/road/neighbourhoods.hpp"
#include "planner/road/passing_order.hpp"
#include "planner/road/road_escot.hpp"
#include "tests/planner/crossing_fixture.hpp"

namespace mvtp {
namespace {

using ContactTables = Crossing;

TEST_F(ContactTables, TellTheSameFromBothSides) {
  const ContactTable& ab = library.contacts(0, 1);
  const ContactTable& ba = library.contacts(1, 0);
  for (double a = 80.0; a < 120.0; a += 0.25) {
    for (double b = 80.0; b < 120.0; b += 0.25) EXPECT_EQ(ab.touches(a, b), ba.touches(b, a));
  }
}

// Car 0 stands with its rear axle at s = 100: its body, with half the margins, reaches 3.6 + 0.3 m
// ahead. Car 2 behind it touches with its front at 0.3 m before that of the margin: s < 100 - 5.1.
TEST_F(ContactTables, HoldTheLengthOfTheCarBehind) {
  const ContactTable& table = library.contacts(0, 2);
  EXPECT_TRUE(table.touches(100.0, 95.25));
  EXPECT_FALSE(table.touches(100.0, 94.5));
}

TEST_F(ContactTables, AreEmptyForPathsThatNeverMeet) {
  EXPECT_TRUE(library.contacts(0, 3).empty());
  EXPECT_FALSE(library.contacts(0, 1).empty());
}

TEST(SpeedProfile, WhoHasLeftDrivesOnAndWhoWaitsStays) {
  const SpeedProfile leaves{.begin = 3, .states = {{10.0, 4.0}, {11.0, 5.0}}};
  EXPECT_EQ(leaves.at(5).s, SpeedProfile::kDeparted);
  EXPECT_EQ(leaves.goes_on_at(4, 0.2), (InertialState{11.0, 5.0}));
  EXPECT_EQ(leaves.goes_on_at(5, 0.2), (InertialState{12.0, 5.0}));
  EXPECT_EQ(leaves.goes_on_at(7, 0.2), (InertialState{14.0, 5.0}));
  const SpeedProfile waits{.begin = 3, .states = {{10.0, 1.0}, {10.5, 0.0}}, .complete = false};
  for (const std::int64_t k : {4, 5, 70}) EXPECT_EQ(waits.goes_on_at(k, 0.2), waits.at(k));
}

TEST_F(Crossing, AloneOnTheRoadAVehicleNeverSlowsDown) {
  const auto plan = plan_vehicle(scene, add(0, 20.0, 13.9), {}, {});
  ASSERT_TRUE(plan);
  for (const InertialState& x : plan->states) EXPECT_NEAR(x.v, 13.9, 1e-9);
  EXPECT_GE(plan->states.back().s, 190.0);
}

TEST_F(Crossing, TheSecondVehicleLetsTheFirstOnePass) {
  add(0, 20.0, 13.9);
  add(1, 20.0, 13.9);
  const auto result = plan_crossing(scene, keys(), {}, {}, 0);
  ASSERT_TRUE(result.unplanned.empty());
  const SpeedProfile& first = *result.plan.find(0);
  const SpeedProfile& second = *result.plan.find(1);
  EXPECT_FALSE(ever_touch(scene.vehicles[0], first, scene.vehicles[1], second));
  // One passes at full speed, and the other is not far behind.
  EXPECT_LT(std::min(arrival_step(first, 110.0), arrival_step(second, 110.0)), 70);
  EXPECT_LT(std::max(arrival_step(first, 110.0), arrival_step(second, 110.0)), 100);
}

TEST_F(Crossing, NobodyStopsWhereAnotherOneWillPass) {
  for (int i = 0; i < 4; ++i) {
    add(0, 60.0 - 15.0 * i, 10.0);
    add(1, 60.0 - 15.0 * i, 10.0);
  }
  const auto result = plan_crossing(scene, keys(), {}, {}, 0);
  ASSERT_TRUE(result.unplanned.empty());
  for (const auto& e : result.plan.entries) {
    const RoadVehicle& v = scene.vehicle(e.key);
    for (std::int64_t k = 0; k < e.profile->end(); ++k) {
      const InertialState x = e.profile->at(k);
      if (x.v > 0.0) continue;
      EXPECT_LT(x.s + kCar.front, 100.0 - kCar.width / 2)
          << "vehicle " << v.key << " at step " << k;
    }
  }
}

// Who finds no plan brakes, and others may lose theirs because of it: then he asks again, and so do
// they. In the end those without one do not all find one, in lane order, around the others.
TEST_F(Crossing, WhoeverIsLeftWithoutAPlanBlocksSomebody) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  CrossingOptions options;
  options.repairs = 0;  // most orders that work are found at once, else
  for (int n = 0; n < 300; ++n) {
    scene.vehicles.clear();
    for (int path : {0, 1, 3}) {
      double s = 92.0;
      for (int i = 0; i < 4; ++i) add(path, s -= 6.0 + 12.0 * share(random), 14.0 * share(random));
    }
    scene.vehicles.erase(scene.vehicles.begin() + 9, scene.vehicles.end());
    JointPlan incumbent;
    for (const RoadVehicle& v : scene.vehicles) {
      if (v.key == 0) continue;
      auto plan = plan_vehicle(scene, v, incumbent.entries, {});
      if (plan) incumbent.entries.push_back({v.key, std::make_shared<SpeedProfile>(*plan)});
    }
    const CrossingResult result = plan_crossing(scene, keys(), incumbent, options, 0);
    std::vector<JointPlan::Entry> entries = result.plan.entries;
    for (const std::int64_t key : PassingOrders(scene).in_lane_order(result.unplanned)) {
      auto plan = plan_vehicle(scene, scene.vehicle(key), entries, {});
      if (plan) entries.push_back({key, std::make_shared<SpeedProfile>(*std::move(plan))});
    }
    EXPECT_TRUE(result.unplanned.empty() || entries.size() < scene.vehicles.size()) << n;
  }
}

//          | 1     A car stands behind the crossing for 20 s. Vehicle 0 gets there first; if it
//          drove
//   0 -----+[ ]    up to that car, it would stand blocking vehicle 1, with no path out.
//          |
TEST_F(Crossing, WaitsBeforeTheCrossingIfItCouldNotClearIt) {
  RoadVehicle obstacle = add(2, 107.5, 0.0);
  scene.vehicles.clear();
  obstacle.key = -1;
  scene.forecasts.push_back({obstacle, {.states = std::vector<InertialState>(200, {107.5, 0.0})}});
  add(0, 60.0, 13.0);
  add(1, 20.0, 8.0);
  const SpeedProfile crossing = plan_alone(scene, scene.vehicles[1], {});
  const std::vector<JointPlan::Entry> before = {{1, std::make_shared<SpeedProfile>(crossing)}};
  ProfileOptions one_speed;
  one_speed.approach_speeds = {1.0};

  const auto plan = plan_vehicle(scene, scene.vehicles[0], before, one_speed);

  ASSERT_TRUE(plan);
  EXPECT_FALSE(ever_touch(scene.vehicles[0], *plan, scene.vehicles[1], crossing));
}

TEST_F(Crossing, EverybodyBrakesNowIsSafeAtEveryDecisionOfAPlan) {
  for (int i = 0; i < 4; ++i) {
    add(0, 70.0 - 15.0 * i, 12.0);
    add(1, 66.0 - 15.0 * i, 12.0);
  }
  const auto result = plan_crossing(scene, keys(), {}, {}, 0);
  ASSERT_TRUE(result.unplanned.empty());
  const auto& entries = result.plan.entries;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const RoadVehicle& a = scene.vehicle(entries[i].key);
      const RoadVehicle& b = scene.vehicle(entries[j].key);
      const std::int64_t end = std::min(entries[i].profile->end(), entries[j].profile->end());
      for (std::int64_t k = 0; k < end; k += scene.grid.steps_per_decision) {
        for (double tau = 0.0; tau < 4.0; tau += 0.05) {
          const double sa = braked_position(entries[i].profile->at(k), 4.5, tau);
          const double sb = braked_position(entries[j].profile->at(k), 4.5, tau);
          ASSERT_FALSE(bodies_touch(a, sa, b, sb)) << a.key << " and " << b.key << " at step " << k;
        }
      }
    }
  }
}

TEST_F(Crossing, BehindAnObstacleThatNeverLeavesThereIsNoCompletePlan) {
  RoadVehicle obstacle = add(2, 120.0, 0.0);
  scene.vehicles.clear();
  obstacle.key = -1;
  scene.forecasts.push_back({obstacle, {.states = {{120.0, 0.0}}, .complete = false}});
  add(0, 20.0, 13.9);
  EXPECT_FALSE(plan_vehicle(scene, scene.vehicles[0], {}, {}).has_value());
}

//   Bodies are 4.5 m long: it stands 0.8 m behind a bus at its stop, where drivers want 3 m.
TEST_F(Crossing, WhoStandsTooNearBehindAnotherOneHasAPlanOnceThatOneDrivesOn) {
  add(0, 139.7, 0.0);
  add_standing_forecast(2, 145.0);
  const RoadVehicle& car = scene.vehicles[0];
  SpeedProfile& bus = scene.forecasts.front().earliest;
  bus.states.assign(200, {145.0, 0.0});  // 20 s
  while (bus.states.back().s < 190.0) {
    bus.states.push_back(advance(bus.states.back(), 1.0, scene.grid.dt));
  }
  bus.complete = true;
  const RoadPairs pairs(scene);
  const auto plan = plan_vehicle(pairs, car, {}, {});
  ASSERT_TRUE(plan);
  EXPECT_TRUE(plan->complete);
  EXPECT_EQ(plan->at(scene.step + 150).s, 139.7);
  EXPECT_FALSE(ever_touch(car, *plan, scene.forecasts.front().vehicle, bus));
}

TEST_F(Crossing, WithoutACompletePlanPbcrStopsTheVehicleInTime) {
  RoadVehicle obstacle = add(2, 120.0, 0.0);
  scene.vehicles.clear();
  obstacle.key = -1;
  scene.forecasts.push_back({obstacle, {.states = {{120.0, 0.0}}, .complete = false}});
  add(0, 20.0, 13.9);
  double s = 20.0;
  int standing = 0;  // decisions; each takes long, for there is no path on
  for (int decision = 0; decision < 60 && standing < 3; ++decision) {
    const RoadDecision next = decide_on_road(scene, {}, {0}, {});
    ASSERT_EQ(next.stepped, 1);
    scene.step += scene.grid.steps_per_decision;
    scene.vehicles[0].now = next.plan.find(0)->at(scene.step);
    s = scene.vehicles[0].now.s;
    ASSERT_LT(s + kCar.front, 120.0 - kCar.rear) << "ran into the obstacle";
    standing = scene.vehicles[0].now.v == 0.0 ? standing + 1 : 0;
  }
  EXPECT_GT(s, 60.0);  // it used the road up to the obstacle, or to the crossing before it
  EXPECT_EQ(scene.vehicles[0].now.v, 0.0);
}

TEST_F(Crossing, APlanIsReplacedOnlyByABetterOne) {
  for (int i = 0; i < 5; ++i) {
    add(0, 70.0 - 14.0 * i, 13.0);
    add(1, 64.0 - 14.0 * i, 13.0);
  }
  CrossingOptions one_analytic_expansion;
  one_analytic_expansion.tries = 0;
  const auto first = plan_crossing(scene, keys(), {}, one_analytic_expansion, 0);
  CrossingOptions search;
  search.tries = 60;
  const auto better = plan_crossing(scene, keys(), first.plan, search, 1);
  EXPECT_LE(better.cost, first.cost);
  const auto again = plan_crossing(scene, keys(), better.plan, one_analytic_expansion, 2);
  EXPECT_NEAR(again.cost, better.cost, 1e-9);
}

//   Vehicle 1 comes across, by a plan of its own, when vehicle 0, which cannot stop any more, is
//   taken over. No order is tried.
TEST_F(Crossing, WhoCannotStopIsMadeRoomFor) {
  add(1, 84.0, 8.0);
  add(3, 20.0, 13.9);
  const CrossingOptions no_search{.tries = 0, .repairs = 0};
  const auto before = plan_crossing(scene, keys(), {}, no_search, 0);
  add(0, 86.0, 12.0);
  ASSERT_FALSE(plan_vehicle(RoadPairs(scene), scene.vehicles[2], before.plan.entries, {}))
      << "there is no need for room";
  const auto result = plan_crossing(scene, keys(), before.plan, no_search, 0);
  ASSERT_TRUE(result.unplanned.empty());
  EXPECT_FALSE(
      ever_touch(scene.vehicles[0], *result.plan.find(0), scene.vehicles[2], *result.plan.find(2)));
  EXPECT_EQ(result.plan.find(1)->states, before.plan.find(1)->states) << "it is not concerned";
}

//   The same, but vehicle 0 may be handed back at any moment: its driver would make no room, so
//   nobody gets a plan that counts on it.
TEST_F(Crossing, WhoLeavesMakesNoRoom) {
  add(1, 84.0, 8.0).s_handback = 80.0;
  const auto before = plan_crossing(scene, keys(), {}, {}, 0);
  add(0, 86.0, 12.0);
  const auto result = plan_crossing(scene, keys(), before.plan, {}, 0);
  EXPECT_EQ(result.plan.find(1), nullptr);
}

TEST_F(Crossing, TheSameSeedGivesTheSamePlan) {
  for (int i = 0; i < 5; ++i) {
    add(0, 70.0 - 14.0 * i, 13.0);
    add(1, 64.0 - 14.0 * i, 13.0);
  }
  const auto a = plan_crossing(scene, keys(), {}, {}, 7);
  const auto b = plan_crossing(scene, keys(), {}, {}, 7);
  ASSERT_EQ(a.plan.entries.size(), b.plan.entries.size());
  for (std::size_t i = 0; i < a.plan.entries.size(); ++i) {
    EXPECT_EQ(a.plan.entries[i].key, b.plan.entries[i].key);
    EXPECT_EQ(a.plan.entries[i].profile->states, b.plan.entries[i].profile->states);
  }
}

TEST_F(Crossing, FollowersHaveTheirHeadwayAtHandBack) {
  for (int i = 0; i < 4; ++i) add(0, 80.0 - 8.0 * i, 8.0);
  const auto result = plan_crossing(scene, keys(), {}, {}, 0);
  ASSERT_TRUE(result.unplanned.empty());
  for (int i = 1; i < 4; ++i) {
    const std::int64_t k = arrival_step(*result.plan.find(i), 170.0);
    const InertialState behind = result.plan.find(i)->at(k);
    const InertialState ahead = result.plan.find(i - 1)->at(k);
    if (ahead.s >= SpeedProfile::kDeparted) continue;
    EXPECT_GE(ahead.s - behind.s - kCar.length(), 2.5 + behind.v * 1.0);
  }
}

//   The one ahead goes on over the next line, more slowly than its old plan said, which ended
//   before.
TEST_F(Crossing, AFollowerIsPlannedAnewIfItsLeaderGoesOnMoreSlowly) {
  add(0, 145.0, 10.0);
  RoadVehicle leader = add(2, 160.0, 6.0);
  scene.vehicles.pop_back();
  const auto alone = plan_crossing(scene, keys(), {}, {}, 0);

  leader.exit_lane = -1;
  leader.entry_lanes = {{.lane = 0, .s_lane = 110.0}};
  leader.cruise_speed = 6.0;
  leader.envelope = std::make_shared<SpeedEnvelope>(std::vector<double>(801, 6.0), 3.5);
  scene.vehicles.push_back(leader);
  const RoadPairs pairs(scene);
  const RoadVehicle& follower = scene.vehicles[0];
  const JointPlan::Entry slow = {
      1, std::make_shared<SpeedProfile>(plan_alone(pairs, scene.vehicles[1], {}))};
  EXPECT_FALSE(leaves_room(pairs, follower, *alone.plan.find(0), std::span(&slow, 1), {}));
  EXPECT_TRUE(leaves_room(pairs, follower, *alone.plan.find(0), {}, {}));

  JointPlan incumbent = alone.plan;
  incumbent.entries.push_back(slow);
  CrossingOptions options;
  options.tries = 0;
  const auto result = plan_crossing(pairs, keys(), incumbent, options, 0);
  ASSERT_TRUE(result.unplanned.empty());
  EXPECT_TRUE(leaves_room(pairs, follower, *result.plan.find(0), std::span(&slow, 1), {}));
}

//   It is driven on behind the place of its hand-back: what counts is the room that it has now.
TEST_F(Crossing, BehindItsHandBackTheRoomOfNowCounts) {
  add(0, 172.0, 10.0);
  add(2, 184.0, 10.0);
  scene.step = 5;
  SpeedProfile own{.begin = 0, .states = {}};
  for (int k = 0; k < 40; ++k) own.states.push_back({160.0 + 2.4 * k, 24.0});
  const JointPlan::Entry ahead = {
      1, std::make_shared<SpeedProfile>(SpeedProfile{.begin = 5, .states = {{184.0, 10.0}}})};
  EXPECT_FALSE(leaves_room(RoadPairs(scene), scene.vehicles[0], own, std::span(&ahead, 1), {}));
  own.states = {{150.0, 0.0}, {172.0, 0.5}, {172.0, 0.5}, {172.0, 0.5}, {172.0, 0.5}, {172.0, 0.5}};
  EXPECT_TRUE(leaves_room(RoadPairs(scene), scene.vehicles[0], own, std::span(&ahead, 1), {}));
}

// Its tail is over the line: it is blocking nobody any more.
TEST_F(Crossing, ALeaderCountsUntilItsTailHasLeftTheLane) {
  add(0, 150.0, 10.0);
  RoadVehicle& leader = add(2, 160.0, 2.0);
  leader.exit_lane = -1;
  leader.entry_lanes = {{.lane = 0, .s_lane = 110.0}};
  const auto keeps_room = [&](double line) {
    scene.vehicles[1].entry_lanes[0].to = line + kCar.length();
    const JointPlan::Entry ahead = {
        1, std::make_shared<SpeedProfile>(SpeedProfile{.states = {{160.0, 2.0}}})};
    const SpeedProfile handed_back{.states = {{170.0 - 14.0, 10.0}}};
    scene.vehicles[0].s_handback = 150.0;
    return leaves_room(RoadPairs(scene), scene.vehicles[0], handed_back, std::span(&ahead, 1), {});
  };
  EXPECT_FALSE(keeps_room(170.0));
  EXPECT_FALSE(keeps_room(157.0));
  EXPECT_TRUE(keeps_room(155.0));
}

TEST_F(Crossing, WhoIsPlannedAnewIsSoWithOneThatItMeets) {
  add(0, 60.0, 10.0);
  add(1, 60.0, 10.0);
  const JointPlan plan = plan_crossing(scene, keys(), {}, {}, 0).plan;
  const RoadPairs pairs(scene);
  const Neighbourhoods neighbourhoods(pairs);
  Draws draws(1);
  for (const std::size_t first : {0U, 1U}) {
    EXPECT_THAT(neighbourhoods.around(plan.entries, first, draws),
                testing::UnorderedElementsAre(0, 1));
  }
}

TEST_F(Crossing, VehiclesWhosePathsNeverMeetAreInDifferentGroups) {
  add(0, 20.0, 10.0);
  add(3, 20.0, 10.0);
  add(2, 60.0, 10.0);
  EXPECT_THAT(group_vehicles(scene),
              testing::ElementsAre(testing::ElementsAre(0, 2), testing::ElementsAre(1)));
}

}  // namespace
}  // namespace mvtp
