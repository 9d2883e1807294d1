#include <cmath>
#include <string>

#include "planner/problem/input_error.hpp"
#include "tests/tools/program_fixture.hpp"
#include "tools/export/formats.hpp"
#include "tools/export/recording.hpp"

namespace mvtp {
namespace {

using testing::HasSubstr;
using testing::Not;

RecordedVehicle vehicle(const std::string& id, const std::vector<RecordedState>& states) {
  return {.id = id, .kind = "", .body = {}, .states = states};
}

/// At x = 0, 1, 2, ... at these times.
RecordedVehicle seen_at(const std::string& id, const std::vector<double>& times) {
  RecordedVehicle seen = vehicle(id, {});
  for (const double t : times) {
    seen.states.push_back({t, {static_cast<double>(seen.states.size()), 0.0, 0.0}, 1.0, 0.0});
  }
  return seen;
}

Recording recording(const std::vector<RecordedVehicle>& vehicles) {
  return {.name = "r", .date = "2026-01-31", .dt = 1.0, .vehicles = vehicles};
}

TEST(Recording, TheMotionOfAnArcIsFound) {
  RecordedVehicle car = vehicle("a", {{.time = 0.0, .pose = {1, 2, 0.3}, .v = NAN}});
  const Pose ahead = drive(car.states[0].pose, 2.0, 0.25);
  car.states.push_back({.time = 0.5, .pose = ahead, .v = NAN});
  car.states.push_back({.time = 1.0, .pose = drive(ahead, -1.0, 0.25), .v = NAN});
  fill_in_motion(car);
  EXPECT_NEAR(car.states[1].v, 4.0, 1e-9);
  EXPECT_NEAR(car.states[1].steer, std::atan(2.0 * 0.25), 1e-9);
  EXPECT_NEAR(car.states[2].v, -2.0, 1e-9);
  EXPECT_NEAR(car.states[2].steer, std::atan(2.0 * 0.25), 1e-9);
}

TEST(Recording, ASpeedThatIsKnownOnlyGetsItsSign) {
  RecordedVehicle car = vehicle("a", {{0.0, {5, 0, 0}, 3.0, 0.0}, {1.0, {2, 0, 0}, 3.1, 0.0}});
  fill_in_motion(car);
  EXPECT_EQ(car.states[1].v, -3.1);
}

TEST(Recording, AVehicleThatWasAwayBecomesTwo) {
  Recording all = recording({seen_at("a", {0, 1, 5, 6}), seen_at("b", {3})});
  split_stays(all);
  ASSERT_EQ(all.vehicles.size(), 3U);
  EXPECT_EQ(all.vehicles[1].id, "a+2");
  EXPECT_EQ(all.vehicles[0].states.size(), 2U);
  EXPECT_EQ(all.vehicles[1].states.front().time, 5.0);
  EXPECT_EQ(all.vehicles[2].id, "b");
}

TEST(Recording, CutLeavesOutWhoIsNotThere) {
  Recording all = recording({seen_at("a", {0, 1, 2}), seen_at("b", {3})});
  cut(all, 1.0, 2.0);
  ASSERT_EQ(all.vehicles.size(), 1U);
  EXPECT_EQ(all.vehicles[0].states.size(), 2U);
}

TEST(Csv, IsInOrderOfTimeAndQuotesIds) {
  EXPECT_EQ(to_csv(recording({seen_at("a,b", {0, 1}), seen_at("c", {0})})),
            "t,id,x,y,yaw,v,steer\n"
            "0.000,\"a,b\",0.0000,0.0000,0.000000,1.0000,0.000000\n"
            "0.000,c,0.0000,0.0000,0.000000,1.0000,0.000000\n"
            "1.000,\"a,b\",1.0000,0.0000,0.000000,1.0000,0.000000\n");
}

TEST(Recording, APartOfAVehicleNeverTakesTheNameOfAnother) {
  Recording all = recording({seen_at("a", {0, 1, 5}), seen_at("a+2", {0})});
  split_stays(all);
  EXPECT_EQ(all.vehicles[1].id, "a+3");
  EXPECT_EQ(all.vehicles[2].id, "a+2");
}

TEST(CommonRoad, AVehicleSeenOnceStandsForAStep) {
  const std::string text = to_commonroad(recording({seen_at("a--b", {3})}), {}).text;
  EXPECT_THAT(text, HasSubstr("<exact>1</exact>"));
  EXPECT_THAT(text, HasSubstr("<!-- a- -b -->"));
}

TEST(CommonRoad, WhoEntersLaterIsCounted) {
  const CommonRoadScenario scenario =
      to_commonroad(recording({seen_at("a", {3, 4}), seen_at("b", {4, 5})}), {});
  EXPECT_EQ(scenario.obstacles, 2U);
  EXPECT_EQ(scenario.late, 1U);
  EXPECT_THAT(scenario.text, HasSubstr("<!-- b -->"));
}

TEST(CommonRoad, WhoEntersLaterIsLeftOutOnDemand) {
  const CommonRoadScenario scenario =
      to_commonroad(recording({seen_at("b", {4, 5}), seen_at("a", {3, 4, 8}), seen_at("c", {3})}),
                    {.ego = "", .obstacle_start_at_zero = true});
  EXPECT_EQ(scenario.obstacles, 2U);
  EXPECT_EQ(scenario.late, 0U);
  EXPECT_THAT(scenario.text, HasSubstr("<!-- a -->"));
  EXPECT_THAT(scenario.text, Not(HasSubstr("<!-- a+2 -->")));
  EXPECT_THAT(scenario.text, Not(HasSubstr("<!-- b -->")));
}

TEST(CommonRoad, TimeBeginsWithTheEgoVehicle) {
  const CommonRoadScenario scenario =
      to_commonroad(recording({seen_at("a", {0, 1, 2, 3}), seen_at("b", {1, 2}),
                               seen_at("ego", {1, 2}), seen_at("c", {2, 3})}),
                    {.ego = "ego", .obstacle_start_at_zero = true});
  EXPECT_EQ(scenario.obstacles, 2U);
  EXPECT_THAT(scenario.text, HasSubstr("<!-- b -->"));
  EXPECT_THAT(scenario.text, Not(HasSubstr("<!-- c -->")));
}

TEST(CommonRoad, AnUnknownEgoIsRefused) {
  EXPECT_THROW((void)to_commonroad(recording({seen_at("a", {0})}), {.ego = "b"}), InputError);
}

TEST(OpenScenario, WhoLeavesBeforeTheEndIsTakenAway) {
  const std::string text =
      to_openscenario(recording({seen_at("a", {0, 1}), seen_at("b", {0, 1, 2, 3})}), "");
  EXPECT_THAT(text, HasSubstr("<Event name=\"exit of a\""));
  EXPECT_THAT(text, Not(HasSubstr("exit of b")));
  EXPECT_THAT(text, Not(HasSubstr("LogicFile")));
}

TEST(OpenScenario, AVehicleSeenOnceStandsForAStep) {
  const std::string text = to_openscenario(recording({seen_at("a", {3})}), "");
  EXPECT_THAT(text, HasSubstr("<Vertex time=\"0.0000\">"));
  EXPECT_THAT(text, HasSubstr("<Vertex time=\"1.0000\">"));
}

TEST(OpenScenario, ANameThatIsAParameterIsRefused) {
  EXPECT_THROW((void)to_openscenario(recording({seen_at("$a", {0})}), ""), InputError);
}

TEST(Xml, HoldsNoControlCharacters) {
  const Recording odd = recording({seen_at("a\x01", {0})});
  EXPECT_THROW((void)to_fcd(odd), InputError);
  EXPECT_THROW((void)to_commonroad(odd, {}), InputError);
  EXPECT_THROW((void)to_openscenario(odd, ""), InputError);
}

using Export = Program;

TEST_F(Export, RefusesWhatItCannotWrite) {
  (void)directory_.file("i.yaml",
                        "agents:\n  - {start: [5, 5, 0], goal: [9, 5, 0]}\n"
                        "map: {dimensions: [20, 20]}\n");
  ASSERT_EQ(run("solve -i i.yaml -q -o p.yaml").exit_code, 0);
  (void)directory_.file("bare.yaml", "schedule:\n  agent0:\n    - {x: 5, y: 5, yaw: 0, t: 0}\n");
  (void)directory_.file("empty.yaml", "schedule: {}\n");
  expect_refused("export p.yaml --to excel -o x.csv", "export: --to: is \"excel\"; choose .*");
  expect_refused("export bare.yaml --to csv -o x.csv",
                 "bare.yaml: does not say what its vehicles are; name its instance .*");
  expect_refused("export p.yaml --to csv -o p.yaml", "p.yaml: .*");
  expect_refused("export p.yaml --to csv -o x.csv --begin 99",
                 "p.yaml: has no vehicle in that time; .*");
  expect_refused("export p.yaml --to csv -o x.csv --ego agent0", "--ego: is for --to commonroad");
  expect_refused("export p.yaml --to csv -o x.csv --obstacle-start-at-zero",
                 "--obstacle-start-at-zero: is for --to commonroad");
  expect_refused("export empty.yaml --to csv -o x.csv --vehicle escot",
                 "empty.yaml: has no vehicle");
  expect_refused("export p.yaml --to commonroad -o x.xml --ego nobody",
                 "--ego: is \"nobody\", which is no vehicle of p.yaml");
  expect_refused("export p.yaml --to openscenario -o x.xosc --network i.yaml",
                 "i.yaml: netconvert cannot write it as OpenDRIVE; .*");
  expect_refused("export . --to csv -o x.csv", ".*view.html: is missing; give the folder .*");
  EXPECT_EQ(shell("ls").out, "bare.yaml\nempty.yaml\ni.yaml\np.yaml\n");
}

TEST_F(Export, ADamagedRunIsToldWhere) {
  (void)directory_.file("view.html", "<html>");
  (void)directory_.file("fcd.xml", "<fcd-export>");
  expect_refused("export . --to csv -o x.csv", ".*view.html: holds no replay; .*");
}

TEST_F(Export, TakesTheVehicleOfAPlanThatNamesNone) {
  (void)directory_.file("bare.yaml",
                        "schedule:\n  agent0:\n    - {x: 5, y: 5, yaw: 0}\n"
                        "    - {x: 4, y: 5, yaw: 0}\n");
  ASSERT_EQ(run("export bare.yaml --to csv -o x.csv --vehicle cl-cbs --dt 2").exit_code, 0);
  EXPECT_THAT(content_of(directory_.path("x.csv")),
              HasSubstr("2.000,agent0,4.0000,5.0000,0.000000,-0.5000,0.000000\n"));
}

}  // namespace
}  // namespace mvtp
