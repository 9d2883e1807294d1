// What is expected of human drivers at signals.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coordinator/drivers/human_drivers.hpp"
#include "tests/coordinator/closed_loop.hpp"
#include "tests/coordinator/mixed_loop.hpp"

namespace mvtp {
namespace {

// Who turns left should wait for him, but may be over before he gets there, or misjudge it.
TEST(HumanTubes, MayHaveToBrakeForOneWhoShouldWaitForThem) {
  const NetworkShape shape = crossroads_with_phases();
  const double length = shape.network.lanes.at("S-C_0").length;
  FakeTrip through{"through", 0.0, "S-C", "C-N"};
  through.at = std::pair(length - 2.0, 0.0);
  FakeTrip turns{"turns", 0.0, "N-C", "C-E"};
  turns.at = std::pair(length - 25.0, 8.0);
  ClosedLoop run(shape, {through, turns}, 0.1, share(0.0));
  run.traffic.insert_now();
  const HumanDrivers& humans = *run.coordinator.humans();
  int both = 0;
  while (run.traffic.time() < 2.0) {
    const bool pass = humans.passes("through") && humans.passes("turns");
    for (int i = 0; i < 5; ++i) run.step();  // a decision
    if (!pass) continue;
    ++both;
    const Forecast f = humans.passages("through").front();
    EXPECT_LT(f.latest->at(f.latest->begin + 20).s, f.vehicle.now.s + 0.1);
  }
  EXPECT_GT(both, 0);
}

// One drives from the west over a signal that is green for him.
TEST(HumanTubes, AreOnTheGroundThatIsExpectedOfThem) {
  ClosedLoop run = loop({{"a", 0.0, "W-C", "C-E"}}, share(0.0));
  const std::vector<int> later = {5, 20};  // steps
  struct Expected {
    Pose from;
    ExpectedGround::Reach reach;
  };
  std::map<std::int64_t, std::vector<Expected>> at;  // by step
  int seen = 0;
  while (run.traffic.running() && run.traffic.time() < 60.0) {
    run.step();
    if (run.traffic.vehicles().empty()) continue;
    const Pose& pose = run.traffic.vehicles().front().pose;
    const std::int64_t step = run.coordinator.steps();
    for (const auto& [from, reach] : at[step]) {
      const double driven = distance(from, pose);
      EXPECT_GE(driven, reach.least - 0.3) << step;
      EXPECT_LE(driven, reach.most + 0.3) << step;
      ++seen;
    }
    const auto ground = run.coordinator.humans()->ground_of("a", pose, step, later);
    if (!ground || !ground->passes) continue;
    EXPECT_EQ(ground->paths.size(), 1U);
    for (std::size_t i = 0; i < later.size(); ++i) {
      at[step + later[i]].push_back({pose, ground->reaches[i]});
    }
  }
  EXPECT_GT(seen, 50);
}

TEST(HumanTubes, WhatWasExpectedLongAgoIsNoGround) {
  ClosedLoop run = loop({{"a", 0.0, "W-C", "C-E"}}, share(0.0));
  const HumanDrivers& humans = *run.coordinator.humans();
  while (!humans.knows("a")) run.step();
  const Pose& pose = run.traffic.vehicles().front().pose;
  EXPECT_TRUE(humans.ground_of("a", pose, run.coordinator.steps(), {}));
  EXPECT_FALSE(humans.ground_of("a", pose, run.coordinator.steps() + 6, {}));
  EXPECT_FALSE(humans.ground_of("b", pose, run.coordinator.steps(), {}));
}

TEST(HumanTubes, HaveAPathForEachTurnThatIsInQuestion) {
  CoordinatorOptions options = share(0.0);
  options.intent = KnownIntent::kLane;
  ClosedLoop run = loop({{"a", 0.0, "W-C", "C-E"}}, options);
  std::size_t most = 0;
  while (run.traffic.running() && run.traffic.time() < 30.0) {
    run.step();
    for (const VehicleState& v : run.traffic.vehicles()) {
      const auto ground =
          run.coordinator.humans()->ground_of(v.id, v.pose, run.coordinator.steps(), {});
      if (ground) most = std::max(most, ground->paths.size());
    }
  }
  EXPECT_EQ(most, 3U);
}

}  // namespace
}  // namespace mvtp
