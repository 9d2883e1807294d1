#include "planner/road/crossing_search.hpp"

#include <gtest/gtest.h>

#include "tests/planner/crossing_fixture.hpp"

namespace mvtp {
namespace {

//   1 -----[driver]----  held at s = 98, so far beside the path of a CAV that has a plan to pass
//   0 ----->             him and is not to come to rest from 90 m to 120 m.
class BesideWhoWaits : public testing::Test {
 protected:
  /// @param apart  of the bodies [m], @param s  of the CAV, at 10 m/s.
  [[nodiscard]] bool keeps_its_plan(double apart, double s, Told told = Told::kToWait) {
    PathLibrary library{Margins{}};
    library.add(straight({0, 0}, {200, 0}), kCar);
    library.add(straight({0, kCar.width + apart}, {200, kCar.width + apart}), kCar);
    RoadVehicle cav{.key = 0, .path = 0, .now = {s, 10.0}};
    cav.envelope = std::make_shared<SpeedEnvelope>(std::vector<double>(801, 13.9), 3.5);
    cav.no_waiting = {{90.0, 120.0}};
    cav.s_handback = 170.0;
    cav.s_end = 190.0;
    SpeedProfile plan{.states = {cav.now}};
    while (plan.states.back().s < cav.s_end) {
      plan.states.push_back(advance(plan.states.back(), 0.0, 0.1));
    }
    const SpeedProfile stands{.states = {{98.0, 0.0}}, .complete = false};
    RoadScene scene;
    scene.library = &library;
    scene.vehicles = {cav};
    scene.forecasts = {{.vehicle = {.key = -1, .path = 1, .now = {98.0, 0.0}, .s_end = 190.0},
                        .earliest = stands,
                        .told = told,
                        .held = stands}};
    const RoadPairs pairs(scene);
    const CrossingOptions options;
    CrossingSearch search(pairs, options, {});
    const JointPlan incumbent{{{0, std::make_shared<SpeedProfile>(plan)}}};
    return search.fitting_incumbent(0, incumbent, {}) != nullptr;
  }
};

TEST_F(BesideWhoWaits, WithItsMarginsFreeItDrivesOn) { EXPECT_TRUE(keeps_its_plan(0.6, 60.0)); }

TEST_F(BesideWhoWaits, WithoutThemItStopsWhereItStillMay) {
  EXPECT_FALSE(keeps_its_plan(0.2, 60.0));
}

// On the junction it would wait for him, and he for it.
TEST_F(BesideWhoWaits, WhereItMayNotAnyMoreItsBodyIsEnough) {
  EXPECT_TRUE(keeps_its_plan(0.2, 82.0));
  EXPECT_FALSE(keeps_its_plan(0.05, 82.0)) << "that is too close";
  EXPECT_FALSE(keeps_its_plan(-0.3, 82.0)) << "it would run into him";
}

TEST_F(BesideWhoWaits, OfNobodyElseIsTheBodyEnough) {
  EXPECT_FALSE(keeps_its_plan(0.2, 82.0, Told::kToPass));
  EXPECT_FALSE(keeps_its_plan(0.2, 82.0, Told::kNothing));
}

}  // namespace
}  // namespace mvtp
