// Vehicles that a coordinator places, on a network whose blocks are shorter than a vehicle drives
// in one step of 1 s: 9.2 m between junctions. (netgenerate --grid, see the header of the network.)
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "tests/traci_bridge/fixtures.hpp"
#include "traci_bridge/sumo_traffic.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Where each vehicle was after each step of a run.
using Recording = std::vector<std::map<std::string, VehicleState>>;

class RemoteControl : public testing::Test {
 protected:
  std::unique_ptr<SumoTraffic> open(const std::string& demand, const std::string& step = "0.1") {
    directory_.write("test.rou.xml", "<routes>" + demand + "</routes>");
    options_.configuration = directory_.write(
        "test.sumocfg", "<configuration><net-file value=\"" +
                            project_file("tests/traci_bridge/short_blocks.net.xml") +
                            R"("/><route-files value="test.rou.xml"/><step-length value=")" + step +
                            R"("/></configuration>)");
    return open_sumo(options_);
  }

  static std::map<std::string, VehicleState> states_of(const SumoTraffic& traffic) {
    std::map<std::string, VehicleState> states;
    for (const VehicleState& v : traffic.vehicles()) states.emplace(v.id, v);
    return states;
  }

  static Recording record(SumoTraffic& traffic, double end) {
    Recording recording;
    while (traffic.running() && traffic.time() < end) {
      traffic.step();
      recording.push_back(states_of(traffic));
    }
    return recording;
  }

  TemporaryDirectory directory_;
  SumoOptions options_;
};

// East through B1, round the block, and through B1 again, to the south.
const std::string kLoop =
    R"(<vehicle id="loop" depart="0" departLane="best" departSpeed="max">
         <route edges="left1A1 A1B1 B1C1 C1C2 C2B2 B2B1 B1B0 B0bottom1"/>)";

class LoopTest : public RemoteControl, public testing::WithParamInterface<bool> {};

TEST_P(LoopTest, ARouteThroughAJunctionTwiceIsFollowedInItsOrder) {
  const bool piecewise = GetParam();  // else all of it is told at once
  const std::string demand = kLoop + "</vehicle>";
  const Recording recording = record(*open(demand), 200.0);
  const auto traffic = open(demand);
  traffic->step();
  traffic->take_over("loop");
  EXPECT_TRUE(traffic->is_taken_over("loop"));
  std::vector<std::string> route = traffic->route("loop");
  ASSERT_EQ(route.size(), 8U);
  for (std::size_t i = 1; i + 60 < recording.size(); ++i) {
    const VehicleState& next = recording[i].at("loop");
    const std::span<const std::string> rest = traffic->route_edges("loop");
    const std::size_t length = piecewise ? 3 : i == 1 ? rest.size() : 0;
    traffic->drive_along("loop", rest.first(std::min(length, rest.size())));
    // Beside the middle of the lane, as nobody drives on it exactly: nearer to one that it crosses.
    traffic->place("loop", compose(next.pose, {0.0, 0.8, 0.0}), next.speed);
    traffic->step();
    const VehicleState now = states_of(*traffic).at("loop");
    const bool right = now.lane == recording[i - 1].at("loop").lane || now.lane == next.lane ||
                       now.lane == recording[i + 1].at("loop").lane;
    ASSERT_TRUE(right) << now.lane << " instead of " << next.lane << ", t = " << traffic->time();
    const std::vector<std::string> left = traffic->route("loop");
    ASSERT_TRUE(std::ranges::equal(left, traffic->route_edges("loop")));
    ASSERT_GE(left.size(), 1U);
    ASSERT_TRUE(std::equal(left.rbegin(), left.rend(), route.rbegin()));  // the true rest
    ASSERT_LE(left.size(), route.size());
    route = left;
  }
  traffic->hand_back("loop");
  EXPECT_FALSE(traffic->is_taken_over("loop"));
  EXPECT_EQ(traffic->route("loop"), route);
  while (traffic->running() && traffic->time() < 200.0) traffic->step();
  EXPECT_THAT(traffic->arrived(), ElementsAre("loop"));
}

INSTANTIATE_TEST_SUITE_P(Pieces, LoopTest, testing::Bool());

/// Drives all vehicles of a demand through the poses of a recording of it; returns how many moves.
int replay(SumoTraffic& traffic, const Recording& recording) {
  int moves = 0;
  for (std::size_t i = 0; i + 1 < recording.size(); ++i) {
    if (i > 0 || traffic.time() > 0.0) {
      for (const VehicleState& v : traffic.vehicles()) {
        const auto next = recording[i].find(v.id);
        const bool stays = next != recording[i].end() && recording[i + 1].contains(v.id);
        if (!stays) {
          traffic.hand_back(v.id);
          continue;
        }
        traffic.take_over(v.id);
        const std::span<const std::string> rest = traffic.route_edges(v.id);
        traffic.drive_along(v.id, rest.first(std::min<std::size_t>(4, rest.size())));
        traffic.place(v.id, next->second.pose, next->second.speed);
        ++moves;
      }
    }
    traffic.step();
  }
  return moves;
}

/// Vehicles of every size between all ends of the network.
std::string mixed_demand() {
  std::string demand =
      R"(<vType id="car" length="4.5" probability="0.7"/>
         <vType id="bus" vClass="bus" length="12" probability="0.2"/>
         <vType id="artic" vClass="trailer" length="18" probability="0.1"/>
         <vTypeDistribution id="mix" vTypes="car bus artic"/>)";
  const std::vector<std::string> in = {"left0A0", "left1A1",  "left2A2",  "bottom1B0",
                                       "top1B2",  "right0C0", "right1C1", "top2C2"};
  const std::vector<std::string> out = {"C0right0",  "C1right1", "A1left1", "B2top1",
                                        "B0bottom1", "A0left0",  "C2top2",  "A2left2"};
  for (std::size_t i = 0; i < in.size(); ++i) {
    for (std::size_t j = 0; j < out.size(); j += 3) {
      demand += "<flow id=\"f" + std::to_string(i) + '.' + std::to_string(j) +
                "\" type=\"mix\" begin=\"" + std::to_string(i) + "\" end=\"120\" period=\"20\"" +
                " departLane=\"best\" departSpeed=\"max\" from=\"" + in[i] + "\" to=\"" +
                out[(i + j) % out.size()] + "\"/>";
    }
  }
  return demand;
}

class ReplayTest : public RemoteControl, public testing::WithParamInterface<const char*> {};

// Every tail reaches back over a whole block. SUMO fails an assertion in such a run unless its
// idea of where their tails are is kept fresh.
TEST_P(ReplayTest, SumoStandsByWhileAllOfItsVehiclesArePlaced) {
  const std::string demand = mixed_demand();
  const Recording recording = record(*open(demand, GetParam()), 200.0);
  const auto traffic = open(demand, GetParam());
  EXPECT_GT(replay(*traffic, recording), 1000);
}

INSTANTIATE_TEST_SUITE_P(StepLengths, ReplayTest, testing::Values("0.1", "0.25", "1"));

TEST_F(RemoteControl, StopsBehindAPieceOfTheRouteAreKept) {
  const auto traffic =
      open(kLoop + R"(<stop lane="B0bottom1_0" endPos="40" duration="20"/></vehicle>)");
  traffic->step();
  traffic->take_over("loop");
  traffic->drive_along("loop", std::vector<std::string>{"left1A1", "A1B1", "B1C1"});
  ASSERT_TRUE(traffic->next_stop("loop").has_value());
  EXPECT_EQ(traffic->next_stop("loop")->lane, "B0bottom1_0");
  traffic->hand_back("loop");
  double stood = 0.0;
  while (traffic->running() && traffic->time() < 300.0) {
    traffic->step();
    for (const VehicleState& v : traffic->vehicles()) stood += v.halted_by_stop ? 0.1 : 0.0;
  }
  EXPECT_NEAR(stood, 20.0, 0.5);
  EXPECT_FALSE(traffic->running());
}

TEST_F(RemoteControl, TheNextStopIsThatOfTheDemandAndNotAHold) {
  const auto traffic = open(
      R"(<vehicle id="a" depart="0"><route edges="left1A1 A1B1 B1C1 C1right1"/>
           <stop lane="C1right1_1" endPos="30" duration="30" until="70"/></vehicle>
         <vehicle id="b" depart="0"><route edges="bottom0A0 A0A1"/></vehicle>)");
  traffic->step();
  EXPECT_FALSE(traffic->next_stop("b").has_value());
  traffic->hold("a", true);
  const std::optional<Stop> stop = traffic->next_stop("a");
  ASSERT_TRUE(stop.has_value());
  EXPECT_EQ(stop->lane, "C1right1_1");
  EXPECT_EQ(stop->edge, "C1right1");
  EXPECT_DOUBLE_EQ(stop->position, 30.0);
  EXPECT_DOUBLE_EQ(stop->duration, 30.0);
  EXPECT_DOUBLE_EQ(stop->until, 70.0);
  EXPECT_FALSE(stop->reached);
  while (traffic->time() < 20.0) traffic->step();
  EXPECT_FALSE(states_of(*traffic).at("a").halted_by_stop);  // it is held
  traffic->hold("a", false);
  while (traffic->time() < 40.0) traffic->step();
  EXPECT_TRUE(traffic->next_stop("a")->reached);
  EXPECT_TRUE(states_of(*traffic).at("a").halted_by_stop);
}

// SUMO's driver knows no path back onto the road.
TEST_F(RemoteControl, AVehicleHandedBackBesideTheRoadIsPutOntoIt) {
  const auto traffic =
      open(R"(<vehicle id="a" depart="0"><route edges="left1A1 A1B1 B1C1 C1right1"/></vehicle>)");
  while (traffic->time() < 2.0) traffic->step();
  traffic->take_over("a");
  Pose meadow = states_of(*traffic).at("a").pose;
  meadow.y += 12.0;
  for (int i = 0; i < 5; ++i) {
    traffic->place("a", meadow, 0.0);
    traffic->step();
  }
  EXPECT_EQ(states_of(*traffic).at("a").lane, "");
  traffic->hand_back("a");
  traffic->step();
  EXPECT_EQ(states_of(*traffic).at("a").lane.substr(0, 7), "left1A1");
  while (traffic->running() && traffic->time() < 100.0) traffic->step();
  EXPECT_THAT(traffic->arrived(), ElementsAre("a"));
}

// SUMO removes who stands for 3 s in a lane that does not lead where it goes.
TEST_F(RemoteControl, AVehicleThatSumoRemovesIsNotTakenOverAnyLonger) {
  options_.extra = {
      "--time-to-teleport.highways",           "3", "--time-to-teleport.remove", "true",
      "--time-to-teleport.highways.min-speed", "1"};
  const auto traffic =
      open(R"(<vehicle id="a" depart="0" departLane="1"><route edges="left1A1 A1A2"/></vehicle>
      <vehicle id="b" depart="60"><route edges="left1A1 A1A2"/></vehicle>)");
  while (traffic->time() < 3.0) traffic->step();
  traffic->take_over("a");
  Pose wrong = states_of(*traffic).at("a").pose;
  wrong.y -= 3.2;
  for (int i = 0; i < 100; ++i) {
    traffic->place("a", wrong, 0.0);
    traffic->step();
  }
  EXPECT_THAT(states_of(*traffic), IsEmpty());
  EXPECT_FALSE(traffic->is_taken_over("a"));
  traffic->place("a", wrong, 0.0);
  traffic->hand_back("a");
  traffic->step();
}

TEST_F(RemoteControl, WhatIsSaidOfAVehicleThatIsNotTakenOverHasNoEffect) {
  const auto traffic =
      open(R"(<vehicle id="a" depart="0"><route edges="left1A1 A1B1"/></vehicle>)");
  traffic->step();
  EXPECT_FALSE(traffic->is_taken_over("a"));
  for (const char* id : {"a", "nobody"}) {
    traffic->place(id, {0.0, 0.0, 0.0}, 0.0);
    traffic->drive_along(id, std::vector<std::string>{"A1B1"});
    traffic->leave_road(id);
    traffic->enter_road(id, "A1B1_0");
    traffic->hand_back(id);
  }
  traffic->step();
  EXPECT_EQ(states_of(*traffic).at("a").lane.substr(0, 7), "left1A1");
}

}  // namespace
}  // namespace mvtp
