// Real runs of SUMO; libsumo holds one simulation per process, and CTest gives each TEST one.
#include "traci_bridge/sumo_traffic.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "tests/traci_bridge/sumo_traffic_fixture.hpp"
#include "traci_bridge/trips.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// Wi_0 runs east at y = -1.6 from x = -300 to -7.2, Eo_0 from there to x = 300.
TEST_F(SumoTrafficTest, ReportsTheRearAxleOfItsVehicles) {
  const auto traffic = open(vehicle("a", 0, "Wi Eo", "departPos=\"100\""));
  EXPECT_DOUBLE_EQ(traffic->time(), 0.0);
  EXPECT_DOUBLE_EQ(traffic->step_length(), kStep);
  EXPECT_THAT(traffic->vehicles(), IsEmpty());
  EXPECT_TRUE(traffic->running());

  traffic->step();

  EXPECT_DOUBLE_EQ(traffic->time(), kStep);
  EXPECT_THAT(traffic->departed(), ElementsAre("a"));
  const VehicleState& a = at(*traffic, "a");
  EXPECT_EQ(a.type, "car");
  EXPECT_NEAR(a.pose.x, -300.0 + 100.0 - 3.6, 1e-6);
  EXPECT_NEAR(a.pose.y, -1.6, 1e-6);
  EXPECT_NEAR(a.pose.theta, 0.0, 1e-9);
  EXPECT_NEAR(a.speed, 13.89, 1e-6);
  EXPECT_DOUBLE_EQ(a.speed_factor, 1.0);
  EXPECT_EQ(a.lane, "Wi_0");
  EXPECT_NEAR(a.lane_position, 100.0, 1e-6);
  EXPECT_THAT(traffic->route("a"), ElementsAre("Wi", "Eo"));
}

TEST_F(SumoTrafficTest, KnowsTheVehicleTypesOfTheScenario) {
  const auto traffic = open(R"(<vType id="bus" length="12" width="2.5" accel="1.2" decel="4"
      tau="1.5" minGap="3" maxSpeed="22"/>)");
  EXPECT_THAT(traffic->types(), ElementsAre("bus", "car"));
  const VehicleType bus = traffic->type("bus");
  EXPECT_DOUBLE_EQ(bus.body.length(), 12.0);
  EXPECT_DOUBLE_EQ(bus.body.width, 2.5);
  EXPECT_DOUBLE_EQ(bus.body.max_accel, 1.2);
  EXPECT_DOUBLE_EQ(bus.body.max_decel, 4.0);
  EXPECT_DOUBLE_EQ(bus.body.max_speed, 22.0);
  EXPECT_DOUBLE_EQ(bus.tau, 1.5);
  EXPECT_DOUBLE_EQ(bus.min_gap, 3.0);
}

TEST_F(SumoTrafficTest, ATakenOverVehicleGoesExactlyWhereItIsPlacedAndDrivesOnAfterwards) {
  options_.tripinfo_output = directory_ / "tripinfo.xml";
  const auto traffic = open(vehicle("a", 0, "Wi Eo", "departPos=\"200\""));
  run_until(*traffic, 1.0);

  traffic->take_over("a");
  Pose pose = at(*traffic, "a").pose;
  double speed = at(*traffic, "a").speed;
  while (pose.x < 30.0) {  // braking to 10 m/s, across the junction
    speed = std::max(10.0, speed - 3.0 * kStep);
    pose.x += speed * kStep;
    traffic->place("a", pose, speed);
    traffic->step();
    const VehicleState& a = at(*traffic, "a");
    ASSERT_NEAR(a.pose.x, pose.x, 1e-9);
    ASSERT_NEAR(a.pose.y, pose.y, 1e-9);
    ASSERT_NEAR(a.pose.theta, pose.theta, 1e-9);
    ASSERT_DOUBLE_EQ(a.speed, speed);
  }
  EXPECT_EQ(at(*traffic, "a").lane, "Eo_0");
  EXPECT_THAT(traffic->route("a"), ElementsAre("Eo"));

  traffic->hand_back("a");
  for (int i = 0; i < 5; ++i) {
    traffic->step();
    const VehicleState& a = at(*traffic, "a");
    EXPECT_NEAR(a.speed, speed + 2.6 * kStep, 1e-3);  // SUMO accelerates from where we left it
    EXPECT_NEAR(a.pose.x, pose.x + a.speed * kStep, 1e-3);
    EXPECT_NEAR(a.pose.y, -1.6, 1e-6);
    pose = a.pose;
    speed = a.speed;
  }
  while (traffic->running()) traffic->step();
  EXPECT_THAT(traffic->arrived(), ElementsAre("a"));
  traffic->close();

  const std::vector<Trip> trips = read_trips(options_.tripinfo_output);
  ASSERT_THAT(trips, SizeIs(1));
  EXPECT_EQ(trips[0].arrival_lane, "Eo_0");
  EXPECT_NEAR(trips[0].route_length, 600.0 - 200.0, 1.0);
  EXPECT_NEAR(trips[0].arrival.value() - trips[0].depart.value(), trips[0].duration, 1e-6);
}

// The lane's limit caps what SUMO believes to be the speed of a vehicle that we move.
TEST_F(SumoTrafficTest, ASpeedAboveTheLimitSurvivesTheHandBack) {
  const auto traffic = open(vehicle("a", 0, "Wi Eo", "departPos=\"100\""));
  run_until(*traffic, 1.0);
  traffic->take_over("a");
  Pose pose = at(*traffic, "a").pose;
  const double speed = 17.0;
  for (int i = 0; i < 10; ++i) {
    pose.x += speed * kStep;
    traffic->place("a", pose, speed);
    traffic->step();
  }

  traffic->hand_back("a");
  traffic->step();

  EXPECT_NEAR(at(*traffic, "a").speed, speed - 4.5 * kStep, 1e-3);  // it brakes to the limit
}

TEST_F(SumoTrafficTest, AVehicleMayLeaveTheRoadAndKeepsItsRoute) {
  const auto traffic = open(vehicle("a", 0, "Wi Eo", "departPos=\"100\""));
  run_until(*traffic, 1.0);
  traffic->take_over("a");
  const Pose meadow{-150.0, 40.0, std::numbers::pi * 0.75};
  traffic->place("a", meadow, 0.0);
  traffic->step();

  const VehicleState& a = at(*traffic, "a");
  EXPECT_NEAR(distance(a.pose, meadow), 0.0, 1e-9);
  EXPECT_NEAR(wrap_to_pi(a.pose.theta - meadow.theta), 0.0, 1e-9);
  EXPECT_EQ(a.lane, "");
  EXPECT_DOUBLE_EQ(a.lane_position, 0.0);
  EXPECT_THAT(traffic->route("a"), ElementsAre("Wi", "Eo"));
}

// A lorry's nose may be further aside than SUMO takes for its lane; nobody must depart before it.
// The lane of the turn from Wi to So has a radius of 5.6 m around (-7.2, -7.2).
TEST_F(SumoTrafficTest, WhoSwingsWideStaysOnItsLaneForAllOthers) {
  const auto traffic = open(R"(<vType id="lorry" length="10" width="2.4"/>
      <vehicle id="a" type="lorry" depart="0" departPos="250"><route edges="Wi So"/></vehicle>
      <vehicle id="b" type="car" depart="5.2"><route edges="So"/></vehicle>)");
  run_until(*traffic, 1.0);
  traffic->take_over("a");
  const double front = traffic->type("lorry").body.front;
  const auto place = [&](const Pose& nose) {
    traffic->place("a", compose(nose, {-front, 0.0, 0.0}), 6.0);
    traffic->step();
  };
  for (double x = -40.0; x < -5.5; x += 1.0) place({x, -1.6, 0.0});
  ASSERT_EQ(at(*traffic, "a").lane, ":C_9_0");
  constexpr double kRadius = 5.6 + 3.2;
  for (double turned = 0.4; turned < 1.5; turned += 0.6 / kRadius) {
    place({-7.2 + kRadius * std::sin(turned), -7.2 + kRadius * std::cos(turned), -turned});
    EXPECT_EQ(at(*traffic, "a").lane, ":C_9_0") << turned;
    EXPECT_EQ(at(*traffic, "a").type, "lorry");
    EXPECT_EQ(find(*traffic, "b"), nullptr) << traffic->time();
  }
  EXPECT_GT(traffic->time(), 5.5) << "it would have departed by now";
}

TEST_F(SumoTrafficTest, AVehicleThatIsNotPlacedAgainStays) {
  const auto traffic = open(vehicle("a", 0, "Wi Eo", "departPos=\"100\""));
  run_until(*traffic, 1.0);
  traffic->take_over("a");
  const Pose meadow{-150.0, 40.0, 0.0};
  traffic->place("a", meadow, 0.0);
  for (int i = 0; i < 20; ++i) traffic->step();
  ASSERT_NE(find(*traffic, "a"), nullptr);
  EXPECT_NEAR(distance(at(*traffic, "a").pose, meadow), 0.0, 1e-9);
}

TEST_F(SumoTrafficTest, PosesThatAreNotFiniteNeverReachSumo) {
  const auto traffic = open(vehicle("a", 0, "Wi Eo"));
  traffic->step();
  traffic->take_over("a");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_THROW(traffic->place("a", {nan, 0.0, 0.0}, 0.0), std::invalid_argument);
  EXPECT_THROW(traffic->place("a", {0.0, inf, 0.0}, 0.0), std::invalid_argument);
  EXPECT_THROW(traffic->place("a", {0.0, 0.0, inf}, 0.0), std::invalid_argument);
  EXPECT_THROW(traffic->place("a", {0.0, 0.0, 0.0}, nan), std::invalid_argument);
}

TEST_F(SumoTrafficTest, AHeldVehicleStopsBeforeTheEndOfItsLaneUntilLetGo) {
  const auto traffic = open(vehicle("a", 0, "Wi Eo", "departPos=\"150\""));
  run_until(*traffic, 1.0);
  traffic->hold("a", true);
  run_until(*traffic, 60.0);
  EXPECT_EQ(at(*traffic, "a").lane, "Wi_0");
  EXPECT_NEAR(at(*traffic, "a").speed, 0.0, 1e-9);
  EXPECT_GT(at(*traffic, "a").lane_position, 292.8 - 5.0);

  traffic->hold("a", false);
  run_until(*traffic, 120.0);
  EXPECT_FALSE(traffic->running());
}

// On the lane that it is on it would wait for ever.
TEST_F(SumoTrafficTest, AHeldVehicleWaitsInALaneFromWhichItsRouteGoesOn) {
  network_ = "crossroads2";
  const auto traffic = open(vehicle("beside", 0, "Wi Eo", "departLane=\"1\"") +
                            vehicle("a", 0, "Wi No", "departLane=\"0\""));
  run_until(*traffic, 0.5);
  ASSERT_EQ(at(*traffic, "a").lane, "Wi_0");
  traffic->hold("a", true);
  run_until(*traffic, 30.0);
  EXPECT_EQ(at(*traffic, "a").lane, "Wi_1");
  EXPECT_NEAR(at(*traffic, "a").speed, 0.0, 1e-9);
  traffic->hold("a", false);
  run_until(*traffic, 40.0);
  EXPECT_EQ(at(*traffic, "a").lane, "No_1");
}

TEST_F(SumoTrafficTest, WhoIsLetThroughPassesTheSignalAtTheEndOfItsLaneOnly) {
  network_ = "crossroads-static";
  const auto traffic = open(vehicle("a", 0, "Wi Eo", "departPos=\"250\"") +
                            vehicle("b", 0, "Si No", "departPos=\"100\""));
  traffic->step();
  traffic->show("C", 10, Light::kRed);
  traffic->show("C", 7, Light::kRed);
  traffic->let_through("a", Passage::kOneLine);
  run_until(*traffic, 10.0);
  EXPECT_EQ(at(*traffic, "a").lane, "Eo_0");
  traffic->let_through("a", Passage::kNone);
  run_until(*traffic, 30.0);
  EXPECT_EQ(at(*traffic, "b").lane, "Si_0");
}

TEST_F(SumoTrafficTest, AHoldThatIsLiftedInTimeLeavesNoTrace) {
  const auto traffic = open(vehicle("a", 0, "Wi Eo", "departPos=\"150\""));
  run_until(*traffic, 1.0);
  traffic->hold("a", true);
  run_until(*traffic, 10.0);
  EXPECT_LT(at(*traffic, "a").speed, 13.0);  // it has begun to brake
  traffic->hold("a", false);
  run_until(*traffic, 18.0);
  EXPECT_NEAR(at(*traffic, "a").speed, 13.89, 1e-6);
  EXPECT_EQ(at(*traffic, "a").lane, "Eo_0");
}

// To cancel the stop then would be an error for SUMO. Vehicles with blue light drive past theirs.
TEST_F(SumoTrafficTest, AHoldBehindItIsNoneAnyMore) {
  const auto traffic = open(vehicle("b", 0, "Wi Eo", "departPos=\"280\"") +
                            vehicle("a", 0, "Wi Eo", "departPos=\"150\""));
  run_until(*traffic, 4.0);
  ASSERT_EQ(at(*traffic, "b").lane, "Eo_0");
  traffic->hold("a", true);
  traffic->step();
  traffic->swap_lanes("a", "b");
  traffic->step();
  ASSERT_EQ(at(*traffic, "a").lane, "Eo_0");
  traffic->hold("a", true);
  run_until(*traffic, 60.0);
  EXPECT_EQ(at(*traffic, "a").lane, "Eo_0") << "held anew, at the end of this lane";
  traffic->hold("a", false);
  run_until(*traffic, 120.0);
  EXPECT_FALSE(traffic->running());
}

TEST_F(SumoTrafficTest, AVehicleTooCloseToBrakeIsNotHeld) {
  const auto traffic = open(vehicle("a", 0, "Wi Eo", "departPos=\"285\""));
  traffic->step();
  traffic->hold("a", true);
  run_until(*traffic, 3.0);
  EXPECT_EQ(at(*traffic, "a").lane, "Eo_0");
}

// There is no room for a stop. He may still change lanes, and waits at the same place then.
TEST_F(SumoTrafficTest, WhoStandsAtTheEndOfItsLaneDoesNotSetOffUntilLetGo) {
  network_ = "crossroads-static";
  const auto traffic = open(vehicle("a", 0, "Wi Eo", "departPos=\"291.7\""));
  traffic->step();
  traffic->show("C", 10, Light::kRed);
  run_until(*traffic, 10.0);
  ASSERT_NEAR(at(*traffic, "a").speed, 0.0, 0.05);
  traffic->hold("a", true);
  traffic->show("C", 10, Light::kGreen);
  traffic->cap_speed("a", 5.0);
  run_until(*traffic, 15.0);
  EXPECT_EQ(at(*traffic, "a").lane, "Wi_0");
  traffic->cap_speed("a", std::numeric_limits<double>::infinity());
  run_until(*traffic, 20.0);
  EXPECT_EQ(at(*traffic, "a").lane, "Wi_0");
  traffic->cap_speed("a", 5.0);
  traffic->hold("a", false);
  run_until(*traffic, 24.0);
  EXPECT_EQ(at(*traffic, "a").lane, "Eo_0");
  EXPECT_NEAR(at(*traffic, "a").speed, 5.0, 1e-6) << "as it was told meanwhile";
}

// Light 10 is that from Wi_0 to Eo_0, light 7 that from Si_0 to No_0.
TEST_F(SumoTrafficTest, DriversHeedTheLightsThatAreShown) {
  network_ = "crossroads-static";
  const auto traffic = open(vehicle("a", 0, "Wi Eo", "departPos=\"150\""));
  traffic->show("C", 10, Light::kRed);
  run_until(*traffic, 50.0);  // its own program has had a green
  EXPECT_EQ(at(*traffic, "a").lane, "Wi_0");
  EXPECT_NEAR(at(*traffic, "a").speed, 0.0, 1e-9);
  traffic->show("C", 10, Light::kGreen);
  run_until(*traffic, 55.0);
  EXPECT_NE(at(*traffic, "a").lane, "Wi_0");
}

TEST_F(SumoTrafficTest, AFreedSignalRunsItsOwnProgram) {
  network_ = "crossroads-static";
  const auto traffic = open(vehicle("a", 0, "Wi Eo", "departPos=\"150\""));
  traffic->show("C", 10, Light::kRed);
  run_until(*traffic, 50.0);
  traffic->free_signal("C");
  run_until(*traffic, 150.0);  // one cycle takes 90 s
  EXPECT_EQ(find(*traffic, "a"), nullptr);
}

TEST_F(SumoTrafficTest, ALightThatTheSignalDoesNotHaveIsAnError) {
  network_ = "crossroads-static";
  const auto traffic = open(vehicle("a", 0, "Wi Eo"));
  EXPECT_THAT(message_of([&] {
                traffic->show("C", 12, Light::kRed);
                return 0;
              }),
              HasSubstr("traffic signal \"C\" has no light 12"));
}

TEST_F(SumoTrafficTest, WhoReliesOnHisSignalYieldsToNobodyNamed) {
  network_ = "crossroads-static";
  for (const bool relies : {false, true}) {
    // Left-turners yield to oncoming traffic even where both have a green arrow.
    const auto traffic = open(vehicle("a", 0, "Wi No", "departPos=\"250\"") +
                              vehicle("b", 0, "Ei Wo", "departPos=\"245\""));
    traffic->step();
    traffic->show("C", 11, Light::kGreen);
    traffic->show("C", 4, Light::kGreen);
    if (relies) traffic->rely_on_signal("a", {"b"});
    double least = 1e9;
    while (find(*traffic, "a") != nullptr && at(*traffic, "a").lane != "No_0") {
      traffic->step();
      least = std::min(least, at(*traffic, "a").speed);
    }
    if (relies) {
      EXPECT_GT(least, 5.0);
    } else {
      EXPECT_LT(least, 2.0);
    }
    traffic->close();
  }
}

TEST_F(SumoTrafficTest, TwoWhoWaitForEachOthersLaneGoOnOnceTheySwap) {
  network_ = "crossroads2";
  const std::string at_end = "departPos=\"289\" departLane=";
  const auto traffic = open(vehicle("left", 0.0, "Wi No", at_end + "\"0\"") +
                            vehicle("right", 0.0, "Wi So", at_end + "\"1\""));
  run_until(*traffic, 60.0);
  ASSERT_EQ(at(*traffic, "left").lane, "Wi_0");
  ASSERT_EQ(at(*traffic, "right").lane, "Wi_1");
  traffic->swap_lanes("left", "right");
  run_until(*traffic, 75.0);
  EXPECT_EQ(at(*traffic, "left").lane, "No_1");
  EXPECT_EQ(at(*traffic, "right").lane, "So_0");
  EXPECT_EQ(traffic->collisions(), 0);
}

TEST_F(SumoTrafficTest, ADetourLeadsWhereTheRouteEnds) {
  network_ = "../tests/traci_bridge/short_blocks";
  const auto traffic =
      open(vehicle("a", 0.0, "left1A1 A1A0 A0B0 B0bottom1", "departPos=\"40\" departLane=\"1\"") +
           vehicle("b", 0.0, "left0A0 A0bottom0", "departPos=\"40\" departLane=\"1\""));
  traffic->step();
  traffic->keep_lane("a", true);
  traffic->keep_lane("b", true);
  run_until(*traffic, 20.0);
  ASSERT_EQ(at(*traffic, "a").lane, "left1A1_1");
  EXPECT_TRUE(traffic->detour("a"));
  EXPECT_THAT(traffic->route("a"), ElementsAre("left1A1", "A1B1", "B1B0", "B0bottom1"));
  EXPECT_TRUE(traffic->detour("b"));
  std::string last;
  traffic->keep_lane("a", false);
  traffic->keep_lane("b", false);
  while (find(*traffic, "a") != nullptr && traffic->time() < 120.0) {
    last = at(*traffic, "a").lane;
    traffic->step();
  }
  EXPECT_THAT(last, HasSubstr("B0bottom1"));
}

TEST_F(SumoTrafficTest, WhoHasNoOtherPathKeepsItsRoute) {
  network_ = "crossroads2";
  const auto traffic = open(vehicle("a", 0.0, "Wi So", "departPos=\"289\" departLane=\"1\""));
  traffic->step();
  EXPECT_FALSE(traffic->detour("a"));
  EXPECT_THAT(traffic->route("a"), ElementsAre("Wi", "So"));
}

TEST_F(SumoTrafficTest, WhoStopsOnItsRouteKeepsIt) {
  network_ = "../tests/traci_bridge/short_blocks";
  const auto traffic = open(
      R"(<vehicle id="a" type="car" depart="0" departPos="40" departLane="1">
         <route edges="left1A1 A1A0 A0B0 B0bottom1"/>
         <stop lane="B0bottom1_0" endPos="30" duration="5"/></vehicle>)");
  traffic->step();
  EXPECT_FALSE(traffic->detour("a"));
  EXPECT_EQ(traffic->route("a").size(), 4U);
}

TEST_F(SumoTrafficTest, ALowerLimitHoldsForEveryDriver) {
  const auto traffic = open(vehicle("a", 0, "Wi Eo", "departPos=\"100\""));
  traffic->limit_speed("Wi_0", 5.0);
  traffic->limit_speed("Wi_0", 20.0);  // limits are only lowered
  run_until(*traffic, 8.0);
  EXPECT_NEAR(at(*traffic, "a").speed, 5.0, 1e-6);
  EXPECT_DOUBLE_EQ(traffic->network().lanes.at("Wi_0").speed_limit, 5.0);
  EXPECT_NEAR(traffic->network().lanes.at("Wi_0").posted_limit.value(), 13.89, 1e-9);
}

// A bicycle could drive at 50 km/h, and wants 20; in a lane for 10 nothing of that is seen.
TEST_F(SumoTrafficTest, KnowsHowFastDriversWantToBe) {
  const auto traffic =
      open(R"(<vType id="bike" vClass="bicycle" speedFactor="0.9" speedDev="0"/>)" +
           vehicle("a", 0, "Wi Eo", "departPos=\"100\"") +
           R"(<vehicle id="b" type="bike" depart="0" departPos="20"><route edges="Wi Eo"/></vehicle>
              <vehicle id="c" type="bike" depart="0" departPos="190"><route edges="Ni So"/></vehicle>)");
  traffic->limit_speed("Ni_0", 10.0 / 3.6);
  traffic->step();
  EXPECT_EQ(at(*traffic, "a").top_speed, std::numeric_limits<double>::infinity());
  EXPECT_NEAR(at(*traffic, "b").top_speed, 0.9 * 20.0 / 3.6, 1e-6);
  EXPECT_EQ(at(*traffic, "c").top_speed, std::numeric_limits<double>::infinity());
  while (at(*traffic, "c").lane == "Ni_0" && traffic->time() < 60.0) traffic->step();
  EXPECT_NEAR(at(*traffic, "c").top_speed, 0.9 * 20.0 / 3.6, 1e-6);
}

TEST_F(SumoTrafficTest, CountsEachPairThatCollidesOnce) {
  const auto traffic = open(vehicle("a", 0, "Wi Eo", "departPos=\"50\"") +
                            vehicle("b", 0, "Wi Eo", "departPos=\"100\""));
  run_until(*traffic, 1.0);
  EXPECT_EQ(traffic->collisions(), 0);
  traffic->take_over("a");
  Pose onto_b = at(*traffic, "b").pose;
  onto_b.x += 13.89 * kStep - 2.0;
  traffic->place("a", onto_b, 13.89);
  traffic->step();
  EXPECT_EQ(traffic->collisions(), 1);
}

TEST_F(SumoTrafficTest, RunsOnThroughAGapInTheDemand) {
  const auto traffic = open(vehicle("a", 0, "Wi Eo") + vehicle("b", 900, "Wi Eo"));
  while (traffic->running()) traffic->step();
  EXPECT_GT(traffic->time(), 900.0);
}

}  // namespace
}  // namespace mvtp
