#include <gtest/gtest.h>

#include "planner/road/crossing.hpp"
#include "tests/planner/crossing_fixture.hpp"

namespace mvtp {
namespace {

/// A vehicle 60 m before ground that is closed for a while.
class ClosedGround : public Crossing {
 protected:
  static constexpr double kFrom = 95.0;
  static constexpr double kTo = 108.0;

  RoadVehicle& arrives(std::vector<ClosedStretch> closed) {
    RoadVehicle& v = add(0, 35.0, 13.0);
    v.closed = std::move(closed);
    return v;
  }

  SpeedProfile planned() {
    const auto t = plan_vehicle(RoadPairs(scene), scene.vehicles[0], {}, {});
    EXPECT_TRUE(t.has_value());
    return t.value_or(SpeedProfile{});
  }
};

TEST_F(ClosedGround, IsEnteredWhenItIsOpenAgainAndNotBefore) {
  arrives({{kFrom, kTo, 0, 150}});
  const SpeedProfile t = planned();
  EXPECT_GE(arrival_step(t, kFrom), 150);
  EXPECT_LE(arrival_step(t, kFrom), 180);
}

TEST_F(ClosedGround, IsLeftBeforeItIsClosed) {
  arrives({{kFrom, kTo, 70, 300}});
  EXPECT_LE(arrival_step(planned(), kTo), 70);  // 73 m at 13 m/s
  scene.vehicles.clear();
  arrives({{kFrom, kTo, 40, 300}});
  EXPECT_GE(arrival_step(planned(), kFrom), 300);
}

TEST_F(ClosedGround, BetweenTwoTimesIsUsedIfThereIsRoom) {
  arrives({{kFrom, kTo, 0, 100}, {kFrom, kTo, 160, 500}});
  const SpeedProfile t = planned();
  EXPECT_GE(arrival_step(t, kFrom), 100);
  EXPECT_LE(arrival_step(t, kTo), 160);
}

TEST_F(ClosedGround, EndsAPlanThatLeadsOntoIt) {
  arrives({});
  const SpeedProfile before = planned();
  EXPECT_TRUE(still_fits(RoadPairs(scene), scene.vehicles[0], before, {}, {}));
  scene.vehicles[0].closed = {{kFrom, kTo, 0, 150}};
  EXPECT_FALSE(still_fits(RoadPairs(scene), scene.vehicles[0], before, {}, {}));
}

TEST_F(ClosedGround, OpenedEarlyIsUsedByThoseWhoAskAgain) {
  arrives({{kFrom, kTo, 0, 300}});
  const JointPlan late{{{0, std::make_shared<SpeedProfile>(planned())}}};
  CrossingOptions options;
  options.tries = 0;
  for (const bool asks : {false, true}) {
    scene.vehicles[0].closed = {{kFrom, kTo, 0, 100}};
    scene.vehicles[0].asks_again = asks;
    const CrossingResult result = plan_crossing(RoadPairs(scene), keys(), late, options, 0);
    const std::int64_t enters = arrival_step(*result.plan.find(0), kFrom);
    if (asks) {
      EXPECT_LE(enters, 130);
    } else {
      EXPECT_GE(enters, 300);
    }
  }
}

}  // namespace
}  // namespace mvtp
