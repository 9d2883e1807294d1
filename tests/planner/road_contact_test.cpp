#include "planner/road/road_contact.hpp"

#include <gtest/gtest.h>

#include "planner/problem/draws.hpp"
#include "planner/road/road_escot.hpp"
#include "planner/road/road_world.hpp"
#include "tests/planner/crossing_fixture.hpp"

namespace mvtp {
namespace {

using RoadContactTest = Crossing;
using OrderOfVehicles = Crossing;
using TooClose = Crossing;
using Forecasts = Crossing;

RoadStepWorld::Motion motion_of(const RoadScene& scene, const SpeedProfile& t, std::int64_t k) {
  const InertialState from = t.at(k);
  const InertialState to = t.at(k + scene.grid.steps_per_decision);
  return {from, held_acceleration(from, to, scene.grid.decision()), to};
}

// One collision test for both: else PBCR finds vehicles whose safe stops conflict.
TEST_F(RoadContactTest, WhatThePlannerAcceptsPbcrAccepts) {
  Draws draws(5);
  int pairs = 0;
  for (int round = 0; round < 150; ++round) {
    scene.vehicles.clear();
    add(0, 60.0 + draws.share() * 30.0, draws.share() * 13.0);
    add(1, 60.0 + draws.share() * 30.0, draws.share() * 13.0);
    add(2, 30.0 + draws.share() * 20.0, draws.share() * 13.0);
    const RoadPairs pairs_now(scene);
    const CrossingResult result = plan_crossing(pairs_now, keys(), {}, {}, std::uint64_t(round));
    const RoadStepWorld world(pairs_now, result.plan, {});
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const SpeedProfile* a = result.plan.find(std::int64_t(i));
        const SpeedProfile* b = result.plan.find(std::int64_t(j));
        if (!a || !b) continue;
        ++pairs;
        for (std::int64_t k = 0; k + 5 < std::min(a->end(), b->end()); k += 5) {
          ASSERT_FALSE(
              world.conflict(int(i), motion_of(scene, *a, k), int(j), motion_of(scene, *b, k)))
              << "round " << round << ", vehicles " << i << " and " << j << " at step " << k;
        }
      }
    }
  }
  EXPECT_GT(pairs, 300);
}

TEST_F(RoadContactTest, IsTheSameFromBothSides) {
  Draws draws(6);
  add(0, 90.0, 8.0);
  add(1, 80.0, 8.0);
  const RoadPairs pairs(scene);
  const JointPlan none;
  const ProfileOptions options;
  const RoadStepWorld world(pairs, none, options);
  for (int round = 0; round < 2000; ++round) {
    std::array<RoadStepWorld::Motion, 2> m;
    for (auto& motion : m) {
      const InertialState from{70.0 + 30.0 * draws.share(), 13.0 * draws.share()};
      const double a = 7.0 * draws.share() - 4.5;
      motion = {from, a, advance(from, a, 0.5)};
    }
    ASSERT_EQ(world.conflict(0, m[0], 1, m[1]), world.conflict(1, m[1], 0, m[0]));
  }
}

// Everyone brakes at any moment: where the test says that two are clear, they are at every
// hundredth of a second.
TEST_F(RoadContactTest, BrakingIsClearAtEveryMoment) {
  Draws draws(7);
  int clear = 0;
  for (int round = 0; round < 3000; ++round) {
    scene.vehicles.clear();
    add(0, 60.0 + 40.0 * draws.share(), 20.0 * draws.share());
    add(draws.between(1, 2), 60.0 + 40.0 * draws.share(), 20.0 * draws.share());
    const RoadVehicle& a = scene.vehicles[0];
    const RoadVehicle& b = scene.vehicles[1];
    const RoadContact contact(scene, a, b, 0.0);
    if (contact.is_close_now()) continue;
    ++clear;
    for (double tau = 0.0; tau < 5.0; tau += 0.01) {
      ASSERT_FALSE(
          bodies_touch(a, braked_position(a.now, 4.5, tau), b, braked_position(b.now, 4.5, tau)))
          << "round " << round << " after " << tau << " s";
    }
  }
  EXPECT_GT(clear, 1000);
}

// Two that are stuck, and move on at once: what counts as clear is so at every moment, also where
// one turns its nose in behind the tail of the other one between two looks.
TEST_F(TooClose, WhoMovesOnBehindATailIsClearBetweenTheLooksToo) {
  library.add(ReferencePath(std::vector<Point>{{-100, 3}, {0, 3}, {30, -9}, {60, -30}}), kCar);
  Draws draws(11);
  int clear = 0;
  for (int round = 0; round < 20000; ++round) {
    scene.vehicles.clear();
    add(draws.between(0, 1) == 0 ? 0 : 4, 92.0 + 16.0 * draws.share(), 0.0).stuck = true;
    add(1, 92.0 + 16.0 * draws.share(), 0.0).stuck = true;
    const RoadVehicle& a = scene.vehicles[0];
    const RoadVehicle& b = scene.vehicles[1];
    const RoadContact contact(scene, a, b, 0.0);
    if (!contact.is_close_now() || gap(a, a.now.s, b, b.now.s) < 0.1) continue;
    const double v_a = 8.0 * draws.share();
    const double v_b = 8.0 * draws.share();
    const auto at_a = [&](double i) { return a.now.s + 0.2 * i * v_a; };
    const auto at_b = [&](double i) { return b.now.s + 0.2 * i * v_b; };
    if (contact.touch(at_a, at_b, 5, true)) continue;
    ++clear;
    for (double i = 0.0; i <= 5.0; i += 0.02) {
      ASSERT_GT(gap(a, at_a(i), b, at_b(i)), 0.0) << "round " << round << ", look " << i;
    }
  }
  EXPECT_GT(clear, 100);
}

// Two noses that are within each other's margins, and one vehicle behind another.
TEST_F(RoadContactTest, TwoBlockEachOtherOnlyIfNeitherCanPassTheOther) {
  add(0, 97.0, 0.0);
  for (const double s : {90.0, 95.2, 110.0}) {
    scene.vehicles.resize(1);
    add(1, s, 0.0);
    const RoadContact contact(scene, scene.vehicles[0], scene.vehicles[1], 0.0);
    const RoadContact other(scene, scene.vehicles[1], scene.vehicles[0], 0.0);
    EXPECT_EQ(contact.block_each_other(), s == 95.2) << s;
    EXPECT_EQ(other.block_each_other(), s == 95.2) << s;
  }
  scene.vehicles.resize(1);
  add(2, 80.0, 0.0);
  EXPECT_FALSE(RoadContact(scene, scene.vehicles[0], scene.vehicles[1], 0.0).block_each_other());
}

// The bare gap between two that are stuck: less is touched, more is passed.
TEST_F(TooClose, TwoThatAreStuckPassEachOtherAtAHairsBreadth) {
  for (const double beside : {0.02, 0.08, 0.15}) {
    const int path = library.add(straight({-100, 1.8 + beside}, {100, 1.8 + beside}), kCar);
    scene.vehicles.clear();
    add(0, 90.0, 0.0).stuck = true;
    add(path, 100.0, 0.0).stuck = true;
    const RoadContact contact(scene, scene.vehicles[0], scene.vehicles[1], 0.0);
    const auto passes = [](int i) { return 90.0 + double(i); };
    const auto stands = [](int) { return 100.0; };
    const bool lenient = contact.is_close(scene.vehicles[0].now, scene.vehicles[1].now);
    EXPECT_EQ(contact.touch(passes, stands, 20, lenient), beside < 0.05) << beside << " m";
  }
}

// A driver's nose at his line, within the margins of somebody's path: if both are stuck, that one
// passes him; but not one who may drive off.
TEST_F(TooClose, WhoIsStuckPassesADriverWhoStaysAtHisLine) {
  const int path = library.add(straight({10, 100}, {10, -100}), kCar);
  const double at_line = 100.0 - kCar.front - kCar.width / 2.0 - 0.15;  // his nose, 0.15 m aside
  for (const auto& [told, stuck] :
       {std::pair(Told::kToWait, true), {Told::kToWait, false}, {Told::kNothing, true}}) {
    scene.vehicles.clear();
    Forecast driver{.vehicle = add(path, at_line, 0.0), .earliest = {}, .told = told};
    scene.vehicles.clear();
    driver.vehicle.key = -1;
    driver.vehicle.stuck = true;
    driver.earliest = {.states = {{at_line, 0.0}}, .complete = false};
    scene.forecasts = {driver};
    RoadVehicle& vehicle = add(0, 90.0, 0.0);
    vehicle.stuck = stuck;
    const auto plan = plan_vehicle(RoadPairs(scene), vehicle, {}, {});
    EXPECT_EQ(plan.has_value(), stuck && told == Told::kToWait);
  }
}

TEST_F(OrderOfVehicles, WhoBlocksAnotherComesBeforeIt) {
  add(0, 60.0, 5.0);   // 0: before the crossing
  add(2, 80.0, 5.0);   // 1: ahead of it in the same lane
  add(1, 100.0, 1.0);  // 2: in the middle of the crossing
  add(1, 70.0, 5.0);   // 3: behind it
  add(0, 120.0, 5.0);  // 4: through
  const RoadPairs pairs(scene);
  EXPECT_TRUE(pairs.leads(1, 0));
  EXPECT_FALSE(pairs.leads(0, 1));
  EXPECT_TRUE(pairs.leads(2, 0));
  EXPECT_TRUE(pairs.leads(2, 1));
  EXPECT_TRUE(pairs.leads(2, 3));
  EXPECT_FALSE(pairs.leads(0, 3));  // both before the crossing: any order
  EXPECT_FALSE(pairs.leads(3, 0));
  EXPECT_TRUE(pairs.leads(4, 0));
  EXPECT_FALSE(pairs.leads(4, 3));
}

TEST_F(OrderOfVehicles, EvenOfTwoInsideTheirMarginsTheFirstIsFirst) {
  add(0, 100.0, 0.0);
  add(2, 95.2, 0.0);  // 0.3 m behind
  const RoadPairs pairs(scene);
  EXPECT_TRUE(pairs.leads(0, 1));
  EXPECT_FALSE(pairs.leads(1, 0));
}

// Drivers stop closer to each other than we would. Nobody may come nearer, and both get away.
TEST_F(TooClose, TwoInsideTheirMarginsComeApartAgain) {
  add(0, 60.0, 0.0);
  add(2, 55.2, 0.0);  // 0.3 m behind
  const double least = gap(scene.vehicles[0], 60.0, scene.vehicles[1], 55.2);
  const RoadDecision decision = decide_on_road(scene, {}, {0, 1}, {});
  EXPECT_EQ(decision.stepped, 0);
  ASSERT_NE(decision.plan.find(0), nullptr);
  ASSERT_NE(decision.plan.find(1), nullptr);
  for (std::int64_t k = 0; k < 50; ++k) {
    const double now = gap(scene.vehicles[0], decision.plan.find(0)->at(k).s, scene.vehicles[1],
                           decision.plan.find(1)->at(k).s);
    ASSERT_GE(now, least - 1e-5) << "at step " << k;
  }
  EXPECT_GE(decision.plan.find(1)->states.back().s, 190.0);
}

//  0 ------------->     The one on the left swings into the lane of the other. They are beside each
//  4 --------.          other, so how far one is ahead is no measure of their distance.
//             `--->
TEST_F(TooClose, WhoSwingsIntoTheLaneBesideItKeepsToWhatBrakingLeaves) {
  library.add(ReferencePath(std::vector<Point>{{-100, 3}, {0, 3}, {30, -9}, {60, -30}}), kCar);
  Draws draws(9);
  int kept = 0;
  for (int round = 0; round < 3000; ++round) {
    scene.vehicles.clear();
    const RoadVehicle a = add(0, 90.0 + 20.0 * draws.share(), 5.0 * draws.share());
    const RoadVehicle b = add(4, 90.0 + 20.0 * draws.share(), 5.0 * draws.share());
    const RoadContact contact(scene, a, b, 0.0);
    double least = gap(a, a.now.s, b, b.now.s);
    for (double tau = 0.0; tau < 2.0; tau += 0.01) {
      least = std::min(
          least, gap(a, braked_position(a.now, 4.5, tau), b, braked_position(b.now, 4.5, tau)));
    }
    if (!contact.is_close_now() || least < 0.0) continue;
    const auto at_a = [&](int i) { return a.now.s + 0.1 * i * a.now.v; };
    const auto at_b = [&](int i) { return b.now.s + 0.1 * i * b.now.v; };
    if (contact.touch(at_a, at_b, 5, true)) continue;
    ++kept;
    for (int i = 0; i <= 5; ++i) {
      ASSERT_GE(gap(a, at_a(i), b, at_b(i)), least - 0.1) << "round " << round << ", look " << i;
    }
  }
  EXPECT_GT(kept, 30);
}

TEST_F(TooClose, NothingMakesADecisionFail) {
  Draws draws(8);
  for (int round = 0; round < 300; ++round) {
    scene.vehicles.clear();
    for (int i = 0; i < 5; ++i) {  // overlapping, too fast, too close, blocking each other
      add(draws.between(0, 2), 80.0 + 30.0 * draws.share(), 13.0 * draws.share());
    }
    const RoadDecision decision = decide_on_road(scene, {}, keys(), {});
    ASSERT_EQ(decision.plan.entries.size(), 5U);
    for (const JointPlan::Entry& e : decision.plan.entries) {
      const RoadVehicle& v = scene.vehicle(e.key);
      ASSERT_EQ(e.profile->at(0), v.now);
      for (std::int64_t k = 0; k + 1 < e.profile->end(); ++k) {
        const double dv = e.profile->at(k + 1).v - e.profile->at(k).v;
        ASSERT_LE(dv, 2.6 * 0.1 + 1e-9);
        ASSERT_GE(dv, -4.5 * 0.1 - 1e-9);
      }
    }
  }
}

// The one behind cannot stop in time any more: it brakes, and the one ahead makes room.
// With the time to notice, braking now ends 3.5 m within the other one, where only the front of a
// body goes further: that is worse, and the vehicle has to brake as hard as it can.
TEST_F(TooClose, WhoMayRunIntoSomebodyBrakes) {
  add_standing_forecast(0, 74.5);  // its rear is 10 m ahead of the front
  add(0, 60.0, 9.0);
  const RoadDecision decision = decide_on_road(scene, {}, {0}, {});
  EXPECT_NEAR(decision.plan.find(0)->at(5).v, 9.0 - 4.5 * 0.5, 1e-9);
}

// The leader is expected to drive on, so that half braking would be no worse than to brake now as
// it is planned: with a moment to notice. At the next decision that would begin anew.
TEST_F(TooClose, BehindAHumanDrivenLeaderItBrakesFully) {
  RoadVehicle leader = add(0, 74.5, 5.0);
  scene.vehicles.pop_back();
  leader.key = -1;
  SpeedProfile motion;
  for (int k = 0; k < 200; ++k) motion.states.push_back({74.5 + 0.5 * k, 5.0});
  scene.forecasts.push_back({leader, motion});
  add(0, 60.0, 9.0);
  const RoadDecision decision = decide_on_road(scene, {}, {0}, {});
  EXPECT_NEAR(decision.plan.find(0)->at(5).v, 9.0 - 4.5 * 0.5, 1e-9);
}

// A leader who is let through may go at once, or hardly: as near as this nobody counts on it.
TEST_F(TooClose, BehindALeaderWhoIsLetThroughItBrakesFully) {
  RoadVehicle leader = add(0, 74.5, 0.3);
  scene.vehicles.pop_back();
  leader.key = -1;
  SpeedProfile early;
  SpeedProfile late;
  for (int k = 0; k < 400; ++k) {
    early.states.push_back({74.5 + 0.01 * k * k, 0.2 * k});
    late.states.push_back({74.5 + 0.0025 * k * k, 0.05 * k});
  }
  scene.forecasts.push_back({leader, early, late, false});
  add(0, 69.5, 2.0);  // 0.5 m behind
  const RoadDecision decision = decide_on_road(scene, {}, {0}, {});
  EXPECT_EQ(decision.plan.find(0)->at(5).v, 0.0);
}

// Whatever it does, it ends up well within the other one, where only the front of a body goes
// further: that is worse.
TEST_F(TooClose, WhoIsTooFastBehindAnotherBrakes) {
  add(0, 74.5, 0.0);
  add(2, 68.0, 9.0);  // 2 m behind
  const RoadDecision decision = decide_on_road(scene, {}, {0, 1}, {});
  EXPECT_NEAR(decision.plan.find(1)->at(5).v, 9.0 - 4.5 * 0.5, 1e-9);
}

//   [===>   Vehicle 0 stands across the path of vehicle 1, which comes from below and cannot
//     ^     stop any more: to brake is all that is left, for what drives on gets deeper into it.
TEST_F(TooClose, WhoCannotStopBeforeOneAcrossItsPathBrakes) {
  const RoadVehicle across = add(0, 98.5, 0.0);
  const RoadVehicle comes = add(1, 90.0, 7.6);
  const RoadContact contact(scene, across, comes, 0.0);
  ASSERT_TRUE(contact.braking_is_too_late());
  const auto stands = [&](int) { return across.now.s; };
  const auto touch = [&](double a) {
    return contact.touch(
        stands, [&](int i) { return advance(comes.now, a, 0.1 * i).s; }, 25, /*lenient=*/true);
  };
  EXPECT_FALSE(touch(-kCar.max_decel));
  EXPECT_TRUE(touch(0.0));
}

TEST_F(TooClose, WhoWillBeRunIntoDrivesOn) {
  add(0, 60.0, 4.0);
  add(2, 53.0, 13.0);
  const RoadDecision decision = decide_on_road(scene, {}, {0, 1}, {});
  EXPECT_GE(decision.plan.find(0)->at(5).v, 4.0);
  EXPECT_LT(decision.plan.find(1)->at(5).v, 12.0);
}

//      |            A guest is let over the crossing and yields to nobody. Whoever has no plan must
//      not
//  us -|-   X       stop blocking its path, even if the guest is still far.
//      f
TEST_F(Forecasts, WhoHasNoPlanStaysOutOfThePassageOfAGuest) {
  RoadVehicle guest = add(1, 70.0, 4.0);
  scene.vehicles.pop_back();
  guest.key = -1;
  SpeedProfile early;
  SpeedProfile late;
  for (int k = 0; k < 400; ++k) {
    early.states.push_back({70.0 + 0.4 * k + 0.01 * k * k, 4.0 + 0.2 * k});
    late.states.push_back({70.0 + 0.4 * k, 4.0});
  }
  scene.forecasts.push_back({guest, early, late, false});
  add_standing_forecast(0, 106.5);  // for ever
  add(0, 95.05, 0.0);
  RoadDecision decision = decide_on_road(scene, {}, {0}, {});
  ASSERT_EQ(decision.stepped, 1);
  EXPECT_EQ(decision.plan.find(0)->at(5), scene.vehicles[0].now);
}

//   f --> us --->     The driver behind sees us; if we waited for him, both would wait for ever.
TEST_F(Forecasts, AHumanDriverWhomWeBlockDoesNotBlockUs) {
  RoadVehicle& own = add(0, 60.0, 0.0);
  own.exit_lane = -1;
  RoadVehicle other = own;
  other.key = -1;
  other.path = 2;
  other.now = {50.0, 10.0};
  SpeedProfile runs_into_us{.states = {other.now}};
  for (int k = 0; k < 150; ++k) {
    runs_into_us.states.push_back(advance(runs_into_us.states.back(), 0.0, 0.1));
  }
  scene.forecasts.push_back({other, runs_into_us});
  const auto plan = plan_vehicle(scene, scene.vehicles[0], {}, {});
  ASSERT_TRUE(plan);
  EXPECT_GT(plan->at(5).v, 1.0);
}

// A guest right ahead may drive off, or stay: whoever is within its margins comes no nearer.
TEST_F(Forecasts, NobodyDrivesIntoAGuestThatMayStay) {
  add(0, 60.0, 0.0);
  RoadVehicle guest = add(2, 64.5 + 0.3, 0.0);
  scene.vehicles.pop_back();
  guest.key = -1;
  SpeedProfile goes{.states = {guest.now}};
  for (int k = 0; k < 150; ++k) goes.states.push_back(advance(goes.states.back(), 2.6, 0.1));
  const SpeedProfile stays{.states = {guest.now}, .complete = false};
  scene.forecasts.push_back({guest, goes, stays, /*yields=*/false});
  const InertialState now = scene.vehicles[0].now;
  const RoadPairs pairs(scene);
  const WaitTest test(pairs, scene.vehicles[0], {}, {});
  EXPECT_TRUE(test.clear_of_forecasts(now, 0.0, now));
  EXPECT_FALSE(test.clear_of_forecasts(now, 2.6, advance(now, 2.6, scene.grid.decision())));
}

// It may brake though it is expected to crawl on at least.
TEST_F(Forecasts, BehindAGuestThatPassesThereIsRoomToStop) {
  add(0, 50.0, 12.0);
  RoadVehicle guest = add(2, 72.0, 12.0);
  scene.vehicles.pop_back();
  guest.key = -1;
  SpeedProfile goes{.states = {guest.now}};
  SpeedProfile crawls = goes;
  for (int k = 0; k < 150; ++k) {
    goes.states.push_back(advance(goes.states.back(), 0.5, 0.1));
    crawls.states.push_back(advance(crawls.states.back(), k < 80 ? -1.0 : 0.0, 0.1));
  }
  scene.forecasts.push_back({guest, goes, crawls, /*yields=*/false});
  const RoadPairs pairs(scene);
  const WaitTest test(pairs, scene.vehicles[0], {}, {});
  const InertialState now = scene.vehicles[0].now;
  EXPECT_TRUE(test.clear_of_forecasts(now, 0.0, advance(now, 0.0, scene.grid.decision())));
  const InertialState fast{50.0, 13.9};
  EXPECT_FALSE(test.clear_of_forecasts(fast, 2.6, advance(fast, 2.6, scene.grid.decision())));
}

TEST_F(Forecasts, ALeaderAheadAlwaysCounts) {
  add_standing_forecast(2, 120.0);
  add(0, 60.0, 10.0);
  EXPECT_FALSE(plan_vehicle(scene, scene.vehicles[0], {}, {}).has_value());
}

TEST_F(Forecasts, CrossTrafficCountsUntilWeBlockIt) {
  RoadVehicle other = add(1, 40.0, 12.0);
  scene.vehicles.clear();
  other.key = -1;
  SpeedProfile crosses{.states = {other.now}};
  for (int k = 0; k < 150; ++k) crosses.states.push_back(advance(crosses.states.back(), 0.0, 0.1));
  scene.forecasts.push_back({other, crosses});
  add(0, 40.0, 12.0);
  EXPECT_FALSE(RoadPairs(scene).follows(0, 0));
  scene.vehicles[0].now = {100.0, 3.0};
  EXPECT_TRUE(RoadPairs(scene).follows(0, 0));
}

//   It has begun to turn left where the driver behind it goes straight on, who does not yield to
//   others; its tail is still before him.
TEST_F(Crossing, ADriverFollowsWhoTurnsOffAheadOfHim) {
  std::vector<Point> turn = {{-100, 0}, {0, 0}};
  for (double a = 0.1; a < 1.5; a += 0.1) turn.push_back({6 * std::sin(a), 6 - 6 * std::cos(a)});
  turn.push_back({6, 60});
  library.add(ReferencePath(turn), kCar);
  Forecast driver{.vehicle = add(0, 92.0, 5.0), .earliest = {}, .yields = false};
  scene.vehicles.clear();
  driver.vehicle.key = -1;
  driver.earliest.states = {driver.vehicle.now};
  scene.forecasts.push_back(driver);
  add(4, 104.7, 0.0);
  EXPECT_TRUE(RoadPairs(scene).follows(0, 0));
  scene.vehicles.front().path = 1;  // one that comes from the right is nobody's leader
  scene.vehicles.front().now.s = 96.0;
  EXPECT_FALSE(RoadPairs(scene).follows(0, 0));
}

}  // namespace
}  // namespace mvtp
