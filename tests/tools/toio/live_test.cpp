#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/tools/program_fixture.hpp"
#include "tests/tools/toio/crossing.hpp"

namespace mvtp {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;

/// Wheels that were told to stop near 0 for ever; slower than any that turn, 22 mm/s [mm/s].
constexpr double kStands = 2.0;
constexpr const char* kStop = "01 01 01 00 02 01 00";

/// `mvtp toio run` and its kin on a private bus, against the emulator in place of BlueZ.
class ToioLive : public Program {
 protected:
  /// The paper's four robots on an A3 mat.
  void export_four() const {
    const std::string instance = std::string(MVTP_SCENARIOS) + "/toio/four.yaml";
    ASSERT_EQ(run("solve -i " + instance + " -o plan.yaml -q").exit_code, 0);
    const Outcome outcome =
        run("toio export plan.yaml -i " + instance + " --mat simple --speed 60 -o run.json -q");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  }

  /// Runs a piece of script, which ends with "mvtp", the program, or runs it beside itself.
  [[nodiscard]] Outcome live(const std::string& emulator, const std::string& script) const {
    (void)directory_.file("script", "mvtp() { exec '" MVTP_PROGRAM "' \"$@\"; }\n" + script + "\n");
    Outcome outcome = shell(
        "timeout -k 5 110 dbus-run-session -- bash -c '\n"
        "export DBUS_SYSTEM_BUS_ADDRESS=$DBUS_SESSION_BUS_ADDRESS\n"
        "rm -f emulator.err\n"  // the one before said that it serves, too
        "\"" MVTP_TOIO_EMULATOR "\" " +
        emulator +
        " >world.json 2>emulator.err & emulator=$!\n"
        "until grep -qs serving emulator.err || ! kill -0 $emulator; do sleep 0.05; done\n"
        "(. ./script) >script.out 2>&1; code=$?\n"
        "kill $emulator; wait $emulator\n"
        "exit $code'");
    outcome.out = content_of(directory_.path("script.out"));
    return outcome;
  }

  /// How the cubes fared.
  [[nodiscard]] json world() const {
    return json::parse(content_of(directory_.path("world.json")));
  }

  [[nodiscard]] json cubes() const { return world()["cubes"]; }

  void expect_all_stopped() const {
    for (const json& cube : cubes()) {
      EXPECT_EQ(cube["last_motor"], kStop) << cube;
      EXPECT_LT(cube["wheels_mm_s"], kStands) << cube;
    }
  }
};

//   Each cube refuses the first connection, and takes 20 bytes at a time.
TEST_F(ToioLive, FourCubesCompleteTheScenario) {
  export_four();
  const Outcome outcome = live("--run run.json --connect-failures 1 --mtu 23 --loss 1",
                               "mvtp toio run run.json --log log.jsonl");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out;
  for (int i = 0; i < 4; ++i) {
    EXPECT_THAT(outcome.out, HasSubstr("agent" + std::to_string(i) + ": arrived after "));
    EXPECT_THAT(outcome.out, HasSubstr("agent" + std::to_string(i) + " is driven by toio-E" +
                                       std::to_string(4 - i)));  // they stand in reverse order
  }
  EXPECT_EQ(world()["touched"], false);
  EXPECT_EQ(cubes().size(), 4u);
  for (const json& cube : cubes()) EXPECT_EQ(cube["dropped"], 0);
  expect_all_stopped();
  EXPECT_THAT(content_of(directory_.path("log.jsonl")),
              HasSubstr("\"to\": \"motor\", \"hex\": \"02"));
}

//   Most settings and their answers are said in vain twice, every fifth message at any time.
TEST_F(ToioLive, NoSingleMessageIsNeeded) {
  (void)directory_.file("run.json", to_json(exported(crossing()).run));
  const Outcome outcome =
      live("--run run.json --lose-settings 2 --loss 20", "mvtp toio run run.json");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out;
  EXPECT_EQ(world()["touched"], false);
  expect_all_stopped();
}

//   The paper's path, over the bus: a cube promises to come within 15 dots of its goal.
TEST_F(ToioLive, TargetsAreDrivenTo) {
  const Exported wide = exported_for_targets();
  ASSERT_EQ(wide.problem, "");
  (void)directory_.file("run.json", to_json(wide.run));
  const Outcome outcome =
      live("--run run.json --loss 5", "mvtp toio run run.json --mode target --log log");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out;
  EXPECT_THAT(content_of(directory_.path("log")), HasSubstr("\"to\": \"motor\", \"hex\": \"03"));
  EXPECT_EQ(world()["touched"], false);
  expect_all_stopped();
  for (std::size_t i = 0; i < 2; ++i) {
    const MatPose& goal = wide.run.robots[1 - i].waypoints.back().pose;  // in reverse order
    EXPECT_NEAR(cubes()[i]["x"], goal.x, 15.0);
    EXPECT_NEAR(cubes()[i]["y"], goal.y, 15.0);
  }
}

//   a's link ends before the crossing; b, which has to wait for a to leave it, stops in time.
TEST_F(ToioLive, ALostLinkStopsWhoNeedsThePlace) {
  (void)directory_.file("run.json", to_json(exported(crossing()).run));
  const Outcome outcome = live("--run run.json --disconnect 2:2.5", "mvtp toio run run.json");
  EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("a (toio-E2a) lost its link\n"));
  EXPECT_THAT(outcome.out,
              HasSubstr("mvtp: stopped: a (toio-E2a) lost its link; b (toio-E1a) could "
                        "not go on\n"));
  EXPECT_EQ(world()["touched"], false);
  EXPECT_EQ(cubes()[0]["last_motor"], kStop);
  for (const json& cube : cubes()) EXPECT_LT(cube["wheels_mm_s"], kStands);
}

//   The same, but the cube is in reach again after a second.
TEST_F(ToioLive, ALinkThatComesBackIsUsedAgain) {
  (void)directory_.file("run.json", to_json(exported(crossing()).run));
  const Outcome outcome = live("--run run.json --disconnect 2:2.5:1", "mvtp toio run run.json");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("a (toio-E2a) lost its link\n"));
  EXPECT_THAT(outcome.out, HasSubstr("a (toio-E2a) is back\n"));
  EXPECT_EQ(world()["touched"], false);
  expect_all_stopped();
}

/// Interrupts the run once `reached`, a command, succeeds.
std::string interrupt_when(const std::string& reached) {
  return "mvtp toio run run.json --log log & pid=$!\n"
         "until " +
         reached +
         " || ! kill -0 $pid; do sleep 0.05; done\n"
         "kill -INT $pid; wait $pid";
}

TEST_F(ToioLive, CtrlCLeavesEveryCubeStopped) {
  (void)directory_.file("run.json", to_json(exported(crossing()).run));
  // Under path: thirty commands were other than to stand.
  const Outcome outcome =
      live("--run run.json",
           interrupt_when("[ \"$(grep motor log | grep -vc '02 01 .. 00 02 .. 00 19')\" -gt 30 ]"));
  EXPECT_EQ(outcome.exit_code, 130) << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("mvtp: interrupted; the cubes are stopped\n"));
  expect_all_stopped();
}

//   After the pause only commands to stand are sent: the last 20 are, ten of each cube.
TEST_F(ToioLive, AButtonPausesAll) {
  (void)directory_.file("run.json", to_json(exported(crossing()).run));
  const Outcome outcome = live(
      "--run run.json --press 1:0.5",
      interrupt_when("[ \"$(grep motor log | tail -n 20 | grep -c '02 01 .. 00 02 .. 00 19')\" "
                     "= 20 ] && grep -q paused script.out"));
  EXPECT_EQ(outcome.exit_code, 130) << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("toio: paused: press Enter or a cube's button to go on\n"));
  EXPECT_LT(cubes()[1]["wheels_mm_s"], kStands);
}

TEST_F(ToioLive, ACollisionIsFeltAndStopsACubeForAWhile) {
  (void)directory_.file("run.json", to_json(exported(crossing()).run));
  const Outcome outcome =
      live("--run run.json --bump 2:1", interrupt_when("grep -q 'is back' script.out"));
  EXPECT_EQ(outcome.exit_code, 130) << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("a (toio-E2a) bumped into something\n"));
}

TEST_F(ToioLive, CubesThatAreElsewhereAreToldWhereTheyBelong) {
  (void)directory_.file("run.json", to_json(exported(crossing()).run));
  const Outcome outcome =
      live("--cubes 2 --mat collection-ring", "mvtp toio run run.json --place-time 0.5");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.out, HasSubstr("degrees off; it belongs at x "));
}

TEST_F(ToioLive, CubesThatAreUnfitAreRefused) {
  (void)directory_.file("run.json", to_json(exported(crossing()).run));
  const auto refused = [&](const std::string& emulator, const std::string& why,
                           const std::string& scan_time = "20") {
    const Outcome outcome = live(emulator, "mvtp toio run run.json --scan-time " + scan_time);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.out, HasSubstr("mvtp: " + why));
  };
  refused("--run run.json --battery 10", "the battery of toio-E1a is at 10 %");
  refused("--run run.json --protocol 2.1.0", "toio-E1a has protocol 2.1.0, at least 2.2.0");
  refused("--run run.json --connect-failures 3", "dev_CA_B3_00_00_00_01 cannot be connected");
  refused("--cubes 1", "1 of 2 cubes found within 3 s; ", "3");
}

TEST_F(ToioLive, WithoutHardwareOneLineSaysSo) {
  (void)directory_.file("run.json", to_json(exported(crossing()).run));
  for (const std::string command :
       {"toio run run.json", "toio scan", "toio calibrate --mat simple"}) {
    const Outcome bus =
        shell("DBUS_SYSTEM_BUS_ADDRESS=unix:path=/nowhere '" MVTP_PROGRAM "' " + command);
    EXPECT_EQ(bus.exit_code, 1);
    EXPECT_THAT(bus.err, MatchesRegex("mvtp: no D-Bus system bus[^\n]*\n"));
  }
  const Outcome adapter = live("--no-adapter", "mvtp toio run run.json");
  EXPECT_EQ(adapter.exit_code, 1);
  EXPECT_THAT(adapter.out, MatchesRegex("mvtp: no Bluetooth adapter[^\n]*\n"));
  const Outcome bluez = shell(
      "dbus-run-session -- bash -c 'DBUS_SYSTEM_BUS_ADDRESS="
      "$DBUS_SESSION_BUS_ADDRESS \"" MVTP_PROGRAM "\" toio scan'");
  EXPECT_EQ(bluez.exit_code, 1);
  EXPECT_THAT(bluez.err, HasSubstr("mvtp: no BlueZ on the bus"));
}

TEST_F(ToioLive, ScanListsTheCubes) {
  const Outcome outcome = live("--cubes 2", "mvtp toio scan --scan-time 3");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.out,
            "toio-E1a CA:B3:00:00:00:01 -50 dBm\ntoio-E2a CA:B3:00:00:00:02 -50 dBm\n");
  EXPECT_EQ(live("--cubes 0", "mvtp toio scan --scan-time 0.3").exit_code, 1);
}

//   The emulated cubes report a centre 3.8 mm behind the axle and drive 2.814 mm/s per unit, their
//   wheels 2 % more or less; frames take 60 ms each way.
TEST_F(ToioLive, CalibrateFindsWhatTheCubesAre) {
  const Outcome outcome = live("--cubes 1 --mat collection-ring --delay 60",
                               "mvtp toio calibrate --mat collection-ring");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out;
  const auto number_after = [&](const std::string& text) {
    const std::size_t at = outcome.out.find(text);
    return at == std::string::npos ? -1.0 : std::stod(outcome.out.substr(at + text.size()));
  };
  EXPECT_NEAR(number_after("wheel axle "), 3.8, 0.6);
  EXPECT_NEAR(number_after("of the wheels "), 2.814, 0.15);
  EXPECT_GT(number_after("lag "), 80);  // and no more than what the computer adds
  EXPECT_LT(number_after("lag "), 300);
}

}  // namespace
}  // namespace mvtp
