#include "planner/road/emergency_braking.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planner/road/crossing.hpp"
#include "tests/planner/crossing_fixture.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Two cars in a row at 10 m/s, and one on a path that meets neither.
class EmergencyBraking : public Crossing {
 protected:
  explicit EmergencyBraking(double behind = 40.0) {
    add(0, 60.0, 10.0);
    add(2, behind, 10.0);
    add(3, 60.0, 10.0);
  }

  [[nodiscard]] std::vector<std::int64_t> braking() const {
    return who_must_brake(scene, plan, {});
  }
  void make_plan() { plan = plan_crossing(scene, keys(), {}, {}, 0).plan; }

  JointPlan plan;
};

TEST_F(EmergencyBraking, NobodyBrakesForNobody) {
  make_plan();
  EXPECT_THAT(braking(), IsEmpty());
}

TEST_F(EmergencyBraking, NobodyBrakesForSomebodyFarAhead) {
  make_plan();
  add_standing_forecast(0, 110.0);
  EXPECT_THAT(braking(), IsEmpty());
}

//   It needs 11 m to stop, and has 13: after another half second it could not any more. The one
//   behind it may go on until the next decision.
TEST_F(EmergencyBraking, WhoCouldNotStopAfterTheNextDecisionBrakesNow) {
  make_plan();
  add_standing_forecast(0, 60.0 + 4.5 + 13.0);
  EXPECT_THAT(braking(), ElementsAre(0));
}

//   The one behind is 4 m away: half a second later it would run into it.
class InARow : public EmergencyBraking {
 protected:
  InARow() : EmergencyBraking(51.5) {}
};

TEST_F(InARow, WhoWouldRunIntoABrakingOneBrakesToo) {
  make_plan();
  add_standing_forecast(0, 60.0 + 4.5 + 21.0);
  EXPECT_THAT(braking(), ElementsAre(0, 1));
}

TEST_F(InARow, WhoBrakesFullyNeedsNotBeTold) {
  make_plan();
  for (const std::int64_t key : {0, 1}) {
    const RoadVehicle& v = scene.vehicles[std::size_t(key)];
    *plan.entry(key) = {key, std::make_shared<SpeedProfile>(stop_after(scene, v.now, -4.5, 4.5))};
  }
  add_standing_forecast(0, 60.0 + 4.5 + 8.0);
  EXPECT_THAT(braking(), IsEmpty());
}

}  // namespace
}  // namespace mvtp
