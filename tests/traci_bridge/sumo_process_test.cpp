// What runs of SUMO leave, inside this process and in one of their own, and what SUMO has against
// scenarios.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/traci_bridge/sumo_traffic_fixture.hpp"
#include "traci_bridge/sumo_traffic.hpp"
#include "traci_bridge/trips.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::SizeIs;

// b waits for the place that a, standing at the start of the lane, does not leave.
TEST_F(SumoTrafficTest, UnfinishedVehiclesAreInTheTripsToo) {
  options_.tripinfo_output = directory_ / "tripinfo.xml";
  const auto traffic = open(vehicle("a", 0, "Wi Eo") + vehicle("b", 5, "Wi No"));
  traffic->step();
  traffic->take_over("a");
  run_until(*traffic, 30.0);
  EXPECT_THAT(traffic->pending(), ElementsAre("b"));
  EXPECT_THAT(traffic->route("b"), ElementsAre("Wi", "No"));
  traffic->close();

  std::vector<Trip> trips = read_trips(options_.tripinfo_output);
  std::ranges::sort(trips, {}, &Trip::id);
  ASSERT_THAT(trips, SizeIs(2));
  EXPECT_TRUE(trips[0].depart.has_value());
  EXPECT_FALSE(trips[0].arrival.has_value());
  EXPECT_FALSE(trips[1].depart.has_value());
  EXPECT_FALSE(trips[1].arrival.has_value());
  EXPECT_NEAR(trips[1].depart_delay, 25.0, 2.0 * kStep);
}

TEST_F(SumoTrafficTest, OutputsGetTheirNamesAtTheEnd) {
  options_.fcd_output = directory_ / "fcd.xml";
  options_.tripinfo_output = directory_ / "tripinfo.xml";
  const auto traffic = open(vehicle("a", 0, "Wi Eo"));
  traffic->step();
  EXPECT_FALSE(std::filesystem::exists(options_.fcd_output));
  traffic->close();
  EXPECT_TRUE(std::filesystem::exists(options_.fcd_output));
  EXPECT_TRUE(std::filesystem::exists(options_.tripinfo_output));
  EXPECT_FALSE(std::filesystem::exists(options_.fcd_output + ".part"));
}

TEST_F(SumoTrafficTest, ARunThatIsGivenUpLeavesNoFile) {
  options_.fcd_output = directory_ / "fcd.xml";
  options_.tripinfo_output = directory_ / "tripinfo.xml";
  open(vehicle("a", 0, "Wi Eo"))->step();
  for (const auto& entry : std::filesystem::directory_iterator(directory_ / "")) {
    EXPECT_THAT(entry.path().filename().string(), MatchesRegex("test\\..*"));
  }
}

/// Everything a run of 100 s shows, in one line per vehicle and step.
std::string transcript(const SumoOptions& options) {
  const auto traffic = open_sumo(options);
  std::string text;
  while (traffic->time() < 100.0) {
    traffic->step();
    if (find(*traffic, "W-straight.0") != nullptr && traffic->time() < 30.0) {
      traffic->take_over("W-straight.0");
      Pose pose = at(*traffic, "W-straight.0").pose;
      pose.x += 0.7;
      traffic->place("W-straight.0", pose, 7.0);
    } else {
      traffic->hand_back("W-straight.0");
    }
    text += std::to_string(traffic->time()) + '\n';
    for (const VehicleState& v : traffic->vehicles()) {
      text += v.id + ' ' + v.type + ' ' + v.lane;
      for (const double x :
           {v.pose.x, v.pose.y, v.pose.theta, v.speed, v.speed_factor, v.lane_position}) {
        text += ' ' + std::to_string(x);
      }
      text += '\n';
    }
  }
  traffic->close();
  return text;
}

TEST(SumoTraffic, ASeparateProcessGivesTheSameFigures) {
  SumoOptions options;
  options.configuration = project_file("scenarios/crossroads/crossroads.sumocfg");
  options.seed = 7;
  const std::string inside = transcript(options);
  options.separate_process = true;
  const std::string outside = transcript(options);
  EXPECT_GT(inside.size(), 10000U);
  EXPECT_TRUE(inside == outside);
  options.seed = 8;
  EXPECT_FALSE(inside == transcript(options));
}

/// The only child of this process.
pid_t child() {
  pid_t pid = 0;
  std::ifstream("/proc/self/task/" + std::to_string(getpid()) + "/children") >> pid;
  return pid;
}

TEST_F(SumoTrafficTest, TheDeathOfASeparateProcessIsReportedAsAnError) {
  options_.separate_process = true;
  const auto traffic = open(vehicle("a", 0, "Wi Eo"));
  traffic->step();
  ASSERT_GT(child(), 0);
  kill(child(), SIGKILL);
  EXPECT_THAT(message_of([&] { traffic->step(); }),
              MatchesRegex(".*/test\\.sumocfg: SUMO stopped after 0\\.10 s: .*"));
  EXPECT_THAT(message_of([&] { traffic->step(); }), HasSubstr("SUMO stopped"));
}

TEST_F(SumoTrafficTest, ASeparateProcessEndsWithTheTraffic) {
  options_.separate_process = true;
  pid_t pid = 0;
  {
    const auto traffic = open(vehicle("a", 0, "Wi Eo"));
    traffic->step();
    pid = child();
    ASSERT_GT(pid, 0);
  }
  EXPECT_NE(kill(pid, 0), 0);
}

// ---- What SUMO has against a scenario is said in one line, and nowhere else. ----

TEST_F(SumoTrafficTest, AnUnknownEdgeIsNamed) {
  testing::internal::CaptureStderr();
  EXPECT_THAT(error_of(vehicle("a", 0, "Wi Atlantis")),
              MatchesRegex(".*/test\\.sumocfg: SUMO does not start: .*Atlantis.*; correct the "
                           "scenario or SUMO's options"));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(SumoTrafficTest, AnUnknownEdgeIsNamedBySeparateProcessesToo) {
  options_.separate_process = true;
  testing::internal::CaptureStdout();
  EXPECT_THAT(error_of(vehicle("a", 0, "Wi Atlantis")),
              MatchesRegex(".*/test\\.sumocfg: SUMO .*Atlantis.*; correct the .*"));
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

TEST_F(SumoTrafficTest, AnErrorLateInTheRoutesEndsTheRunWithoutFiles) {
  options_.fcd_output = directory_ / "fcd.xml";
  testing::internal::CaptureStderr();
  EXPECT_THAT(error_of(vehicle("a", 0, "Wi Eo") + vehicle("b", 500, "Wi Eo") +
                           vehicle("c", 900, "Wi Atlantis"),
                       9000),
              MatchesRegex(".*/test\\.sumocfg: SUMO stopped after .* s: .*Atlantis.*"));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_FALSE(std::filesystem::exists(options_.fcd_output));
  EXPECT_FALSE(std::filesystem::exists(options_.fcd_output + ".part"));
}

TEST_F(SumoTrafficTest, ARouteWithoutConnectionIsNamed) {
  EXPECT_THAT(error_of(vehicle("a", 0.5, "Wi Wo"), 20),
              MatchesRegex(".*/test\\.sumocfg: SUMO .*No connection between edge 'Wi' and edge "
                           "'Wo'.*"));
}

TEST_F(SumoTrafficTest, BrokenRoutesAreAnError) {
  EXPECT_THAT(error_of("<vehicle"), MatchesRegex(".*/test\\.sumocfg: SUMO does not start: .*"));
}

TEST_F(SumoTrafficTest, UnwritableOutputsAreNamedBeforeSumoStarts) {
  options_.fcd_output = "/nowhere/fcd.xml";
  EXPECT_THAT(error_of(""), MatchesRegex("/nowhere/fcd\\.xml: cannot be written \\(No such file or "
                                         "directory\\); choose another directory"));
  options_.fcd_output = directory_ / "";
  EXPECT_THAT(error_of(""), MatchesRegex(".*: is a directory; give .*"));
  options_.fcd_output = directory_ / "12:30.xml";
  EXPECT_THAT(error_of(""), MatchesRegex(".*/12:30\\.xml: SUMO takes a path with a colon .*"));
}

TEST_F(SumoTrafficTest, MoreOptionsOfSumoAreGivenOn) {
  options_.extra = {"--step-length", "0.5"};
  EXPECT_DOUBLE_EQ(open("")->step_length(), 0.5);
}

TEST_F(SumoTrafficTest, OptionsThatAreOursAreRefused) {
  for (const char* option : {"--seed", "--time-to-teleport", "--help", "-n", "--fcd-output=x"}) {
    options_.extra = {option, "1"};
    EXPECT_THAT(error_of(""), MatchesRegex("SUMO option -[^=]*: this program sets .*")) << option;
  }
  options_.extra = {"--no-such-option", "1"};
  EXPECT_THAT(error_of(""), HasSubstr("No option with the name 'no-such-option' exists."));
}

TEST(SumoTraffic, KnowsItsVersion) { EXPECT_THAT(sumo_version(), MatchesRegex("SUMO [0-9.]+.*")); }

}  // namespace
}  // namespace mvtp
