#include "traci_bridge/network.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <ranges>
#include <string>
#include <vector>

#include "planner/problem/interruption.hpp"
#include "tests/traci_bridge/fixtures.hpp"
#include "traci_bridge/configuration.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::SizeIs;
using testing::StartsWith;
using testing::UnorderedElementsAre;

RoadNetwork crossroads() { return read_network(project_file("networks/crossroads.net.xml")); }

const Connection& connection(const Junction& junction, const std::string& from,
                             const std::string& to) {
  return *std::ranges::find_if(junction.connections, [&](const Connection& c) {
    return c.from_lane == from && c.to_lane == to;
  });
}

TEST(ReadNetwork, TheCrossroadsHaveFourArmsAndTwelveConnections) {
  const RoadNetwork network = crossroads();

  EXPECT_THAT(network.edges, SizeIs(8));
  EXPECT_THAT(network.junctions, SizeIs(5));
  const Junction& c = network.junctions.at("C");
  EXPECT_EQ(c.type, "priority");
  EXPECT_EQ(c.position, (Point{0.0, 0.0}));
  EXPECT_THAT(c.incoming_lanes, ElementsAre("Ni_0", "Ei_0", "Si_0", "Wi_0"));
  EXPECT_THAT(c.connections, SizeIs(12));
  EXPECT_TRUE(c.has_conflicts);
  EXPECT_FALSE(network.junctions.at("E").has_conflicts);
}

TEST(ReadNetwork, ConnectionsKnowTheirLights) {
  const RoadNetwork network = read_network(project_file("networks/crossroads-static.net.xml"));
  const Connection& c = connection(network.junctions.at("C"), "Wi_0", "Eo_0");
  EXPECT_EQ(c.signal, "C");
  EXPECT_EQ(c.signal_index, 10);
  EXPECT_EQ(network.signals.at("C"), 12);
  EXPECT_THAT(crossroads().signals, IsEmpty());
}

TEST(ReadNetwork, CrossingsKnowTheirEndsLightsAndPriority) {
  const RoadNetwork lights = read_network(project_file("networks/crossings-static.net.xml"));
  const std::vector<PedestrianCrossing>& crossings = lights.junctions.at("C").crossings;
  ASSERT_THAT(crossings, SizeIs(4));
  EXPECT_EQ(crossings[0].id, ":C_c0");
  EXPECT_EQ(crossings[0].width, 4.0);
  EXPECT_THAT(crossings[0].shape, ElementsAre(Point{3.2, 5.2}, Point{-3.2, 5.2}));
  EXPECT_THAT(crossings[0].ends, UnorderedElementsAre(":C_w0", ":C_w1"));
  EXPECT_EQ(crossings[0].signal, "C");
  EXPECT_THAT(crossings[0].lights, ElementsAre(12));
  EXPECT_EQ(lights.signals.at("C"), 16);
  EXPECT_FALSE(lights.lanes.contains(":C_c0_0"));

  const RoadNetwork zebras = read_network(project_file("networks/crossings.net.xml"));
  for (const PedestrianCrossing& zebra : zebras.junctions.at("C").crossings) {
    EXPECT_TRUE(zebra.has_priority);
    EXPECT_THAT(zebra.lights, IsEmpty());
  }
  EXPECT_THAT(zebras.junctions.at("E").crossings, IsEmpty());
}

TEST(ReadNetwork, LanesHaveTheirShapeAndLimits) {
  const RoadNetwork network = crossroads();
  const Lane& lane = network.lanes.at("Ei_0");

  EXPECT_EQ(lane.edge, "Ei");
  EXPECT_DOUBLE_EQ(lane.speed_limit, 13.89);
  EXPECT_DOUBLE_EQ(lane.length, 292.8);
  EXPECT_DOUBLE_EQ(lane.width, 3.2);
  EXPECT_FALSE(lane.internal);
  EXPECT_TRUE(lane.drivable);
  EXPECT_THAT(lane.shape, ElementsAre(Point{300.0, 1.6}, Point{7.2, 1.6}));
}

TEST(ReadNetwork, LanesKnowWhomTheyAllow) {
  const Lane open{};
  EXPECT_TRUE(open.allows("passenger"));
  EXPECT_TRUE(open.allows("bicycle"));
  const Lane named{.allowed = {"bus", "taxi"}};
  EXPECT_TRUE(named.allows("bus"));
  EXPECT_FALSE(named.allows("passenger"));
  const Lane banned{.banned = {"truck"}};
  EXPECT_TRUE(banned.allows("passenger"));
  EXPECT_FALSE(banned.allows("truck"));
  EXPECT_TRUE((Lane{.allowed = {"all"}}).allows("ship"));
  EXPECT_FALSE((Lane{.banned = {"all"}}).allows("passenger"));
}

// A left turn from the major road waits inside the junction: two internal lanes, end to end.
TEST(ReadNetwork, ALeftTurnThatWaitsIsAChainOfTwoInternalLanes) {
  const RoadNetwork network = crossroads();
  const Connection& left = connection(network.junctions.at("C"), "Wi_0", "No_0");

  ASSERT_THAT(left.via, ElementsAre(":C_11_0", ":C_13_0"));
  EXPECT_TRUE(network.lanes.at(":C_13_0").internal);
  EXPECT_EQ(network.lanes.at("Wi_0").shape.back(), network.lanes.at(":C_11_0").shape.front());
  EXPECT_EQ(network.lanes.at(":C_11_0").shape.back(), network.lanes.at(":C_13_0").shape.front());
  EXPECT_EQ(network.lanes.at(":C_13_0").shape.back(), network.lanes.at("No_0").shape.front());
}

class EveryNetwork : public testing::TestWithParam<const char*> {};

TEST_P(EveryNetwork, ConnectionsAreContinuousFromLaneToLane) {
  set_sumo_home();
  std::string path = GetParam();
  path = path.starts_with("tools/") ? std::string(std::getenv("SUMO_HOME")) + '/' + path
                                    : project_file(path);
  const RoadNetwork network = read_network(path);

  int connections = 0;
  for (const Junction& junction : std::views::values(network.junctions)) {
    for (const Connection& c : junction.connections) {
      ++connections;
      EXPECT_THAT(junction.incoming_lanes, testing::Contains(c.from_lane));
      std::vector<std::string> chain = {c.from_lane};
      chain.insert(chain.end(), c.via.begin(), c.via.end());
      chain.push_back(c.to_lane);
      for (std::size_t i = 1; i < chain.size(); ++i) {
        const Point a = network.lanes.at(chain[i - 1]).shape.back();
        const Point b = network.lanes.at(chain[i]).shape.front();
        EXPECT_LT(std::hypot(a.x - b.x, a.y - b.y), 0.02) << chain[i - 1] << " -> " << chain[i];
      }
    }
  }
  EXPECT_GE(connections, 12);
}

INSTANTIATE_TEST_SUITE_P(
    Shipped, EveryNetwork,
    testing::Values("networks/crossroads.net.xml", "networks/crossroads-static.net.xml",
                    "networks/crossroads-actuated.net.xml", "networks/crossroads2.net.xml",
                    "networks/crossroads2-static.net.xml", "networks/crossroads2-actuated.net.xml",
                    "tools/sumolib/scenario/scenarios/RealWorld/RiLSA_example1/net.net.xml"));

TEST(ReadNetwork, TheTwinsWithALightHaveTheSameLanesOutsideTheJunction) {
  for (const std::string name : {"crossroads", "crossroads2"}) {
    const RoadNetwork plain = read_network(project_file("networks/" + name + ".net.xml"));
    for (const std::string light : {"-static", "-actuated"}) {
      const RoadNetwork twin = read_network(project_file("networks/" + name + light + ".net.xml"));
      EXPECT_EQ(twin.junctions.at("C").type, "traffic_light");
      EXPECT_EQ(twin.junctions.at("C").shape, plain.junctions.at("C").shape);
      for (const Lane& lane : std::views::values(plain.lanes)) {
        if (!lane.internal) {
          EXPECT_EQ(twin.lanes.at(lane.id).shape, lane.shape);
        }
      }
    }
  }
}

/// Two one-way streets from the west and the south that cross at J, with `extra` elements.
//
//        n
//        |
//   w -- J -- e
//        |
//        s
std::string crossing(const std::string& lanes_of_sj, const std::string& extra) {
  return R"(<net>
    <edge id=":J_0" function="internal"><lane id=":J_0_0" index="0" speed="10" length="10" shape="-5,0 5,0"/></edge>
    <edge id=":J_1" function="internal"><lane id=":J_1_0" index="0" speed="10" length="10" shape="0,-5 0,5"/></edge>
    <edge id="wJ" from="w" to="J"><lane id="wJ_0" index="0" speed="10" length="95" shape="-100,0 -5,0"/></edge>
    <edge id="Je" from="J" to="e"><lane id="Je_0" index="0" speed="10" length="95" shape="5,0 100,0"/></edge>
    <edge id="sJ" from="s" to="J">)" +
         lanes_of_sj + R"(</edge>
    <edge id="Jn" from="J" to="n"><lane id="Jn_0" index="0" speed="10" length="95" shape="0,5,1 0,100,1"/></edge>
    <junction id="J" type="unregulated" x="0" y="0" incLanes="wJ_0 sJ_0" shape="-5,-5 5,-5 5,5 -5,5 -5,-5"/>
    <connection from="wJ" to="Je" fromLane="0" toLane="0" via=":J_0_0"/>
    <connection from=":J_0" to="Je" fromLane="0" toLane="0"/>
    )" + extra +
         "</net>";
}

const std::string kOpenLane =
    R"(<lane id="sJ_0" index="0" speed="10" length="95" shape="0,-100 0,-5"/>)";
const std::string kBusLane =
    R"(<lane id="sJ_0" index="0" speed="10" length="95" allow="bus tram" shape="0,-100 0,-5"/>)";
const std::string kStraightOn =
    R"(<connection from="sJ" to="Jn" fromLane="0" toLane="0" via=":J_1_0"/>)";

RoadNetwork parse(const std::string& net) {
  const TemporaryDirectory directory;
  return read_network(directory.write("test.net.xml", net));
}

/// The same streets with a crossing for people at J.
std::string with_crossing(const std::string& shape) {
  std::string net = crossing(
      kOpenLane, kStraightOn +
                     R"(<edge id=":J_c0" function="crossing"><lane id=":J_c0_0" index="0" )"
                     R"(allow="pedestrian" speed="1" length="6" width="4" shape=")" +
                     shape + R"("/></edge>)");
  const std::string lanes = " incLanes=";
  return net.insert(net.find(lanes), R"( intLanes=":J_0_0 :J_1_0 :J_c0_0")");
}

TEST(ReadNetwork, ACrossingHasNoPointTwice) {
  const RoadNetwork network = parse(with_crossing("7,3 7,3 7,0 7,-3 7,-3"));
  ASSERT_THAT(network.junctions.at("J").crossings, SizeIs(1));
  EXPECT_THAT(network.junctions.at("J").crossings[0].shape,
              ElementsAre(Point{7, 3}, Point{7, 0}, Point{7, -3}));
}

TEST(ReadNetwork, ACrossingLeadsSomewhere) {
  EXPECT_THAT(message_of([] { parse(with_crossing("7,3 7,3")); }),
              testing::HasSubstr("crossing \":J_c0\" has no shape"));
}

// SUMO writes -1 for the connections at a signal that it does not control.
TEST(ReadNetwork, AConnectionWithoutALightObeysNoSignal) {
  const RoadNetwork network = parse(crossing(
      kOpenLane,
      R"(<connection from="sJ" to="Jn" fromLane="0" toLane="0" via=":J_1_0" tl="J" linkIndex="-1"/>)"));
  EXPECT_EQ(network.junctions.at("J").connections.back().signal, "");
  EXPECT_TRUE(network.signals.empty());
}

TEST(ReadNetwork, ConnectionsThatCrossAreInConflictEvenWhereNobodyYields) {
  EXPECT_TRUE(parse(crossing(kOpenLane, kStraightOn)).junctions.at("J").has_conflicts);
  EXPECT_FALSE(parse(crossing(kOpenLane, "")).junctions.at("J").has_conflicts);
}

TEST(ReadNetwork, ConnectionsOfBusesAloneAreInConflictThoseOfTramsAndBicyclesAreNot) {
  const RoadNetwork network = parse(crossing(kBusLane, kStraightOn));
  EXPECT_FALSE(network.lanes.at("sJ_0").drivable);
  EXPECT_TRUE(network.lanes.at("sJ_0").road);
  EXPECT_TRUE(network.lanes.at("sJ_0").allows("bus"));
  EXPECT_TRUE(network.junctions.at("J").has_conflicts);
  for (const std::string allowed : {"tram", "bicycle"}) {
    std::string lane = kBusLane;
    lane.replace(lane.find("bus tram"), 8, allowed);
    EXPECT_FALSE(parse(crossing(lane, kStraightOn)).junctions.at("J").has_conflicts) << allowed;
  }
}

TEST(ReadNetwork, HeightsAndTheClosingPointOfAPolygonAreDropped) {
  const RoadNetwork network = parse(crossing(kOpenLane, ""));
  EXPECT_THAT(network.lanes.at("Jn_0").shape, ElementsAre(Point{0.0, 5.0}, Point{0.0, 100.0}));
  EXPECT_THAT(network.junctions.at("J").shape, SizeIs(4));
}

TEST(ReadNetwork, FootpathsAreLeftOut) {
  const RoadNetwork network = parse(crossing(
      kOpenLane,
      R"(<edge id=":J_w0" function="walkingarea"><lane id=":J_w0_0" index="0" speed="1" length="5" shape="0,0 1,1"/></edge>
         <connection from="sJ" to=":J_w0" fromLane="0" toLane="0"/>)"));
  EXPECT_FALSE(network.lanes.contains(":J_w0_0"));
  EXPECT_THAT(network.junctions.at("J").connections, SizeIs(1));
}

std::string error_of(const std::string& net) {
  return message_of([&] { parse(net); });
}

TEST(ReadNetwork, ErrorsNameTheLineAndTheValue) {
  EXPECT_THAT(error_of(crossing(
                  R"(<lane id="sJ_0" index="0" speed="fast" length="95" shape="0,0 1,1"/>)", "")),
              MatchesRegex(R"(.*/test\.net\.xml:6: <lane> speed: "fast" is not a finite number)"));
  EXPECT_THAT(error_of(crossing(
                  R"(<lane id="sJ_0" index="0" speed="-1" length="95" shape="0,0 1,1"/>)", "")),
              MatchesRegex(R"(.*:6: <lane> speed: "-1" is not above 0)"));
  EXPECT_THAT(error_of(crossing(
                  R"(<lane id="sJ_0" index="0" speed="1" length="nan" shape="0,0 1,1"/>)", "")),
              MatchesRegex(R"(.*:6: <lane> length: "nan" is not a finite number)"));
  EXPECT_THAT(error_of(crossing(
                  R"(<lane id="sJ_0" index="0" speed="1" length="1e999" shape="0,0 1,1"/>)", "")),
              MatchesRegex(R"(.*:6: <lane> length: "1e999" is not a finite number)"));
  EXPECT_THAT(
      error_of(crossing(R"(<lane id="sJ_0" index="0" speed="1" length="9" shape="0,0 1;1"/>)", "")),
      MatchesRegex(R"(.*:6: <lane> shape: "1;1" is not a point x,y)"));
  EXPECT_THAT(
      error_of(crossing(R"(<lane id="sJ_0" index="7" speed="1" length="9" shape="0,0 1,1"/>)", "")),
      MatchesRegex(R"(.*:6: lane "sJ_0" is not the next of its edge)"));
  EXPECT_THAT(error_of(crossing("", "")), MatchesRegex(R"(.*:6: edge "sJ" has no lanes)"));
  EXPECT_THAT(
      error_of(crossing(kOpenLane, R"(<connection from="sJ" to="Jn" fromLane="3" toLane="0"/>)")),
      MatchesRegex(R"(.*:11: edge "sJ" has no lane 3)"));
  EXPECT_THAT(error_of(crossing(
                  kOpenLane, R"(<connection from="sJ" to="Jn" fromLane="0" toLane="0" via="?"/>)")),
              MatchesRegex(R"(.*:11: the internal lanes from "sJ_0" to "Jn_0" do not end: "\?")"));
}

TEST(ReadNetwork, WhatNoRoadMeasuresIsRefused) {
  const auto lane = [](const std::string& width, const std::string& length,
                       const std::string& shape) {
    return "<lane id=\"sJ_0\" index=\"0\" speed=\"1\" width=\"" + width + "\" length=\"" + length +
           "\" shape=\"" + shape + "\"/>";
  };
  const std::string line = "0,-100 0,-5";
  for (const auto& [text, message] :
       {std::pair{lane("3", "1e9", line), R"(long, more than 100000 m; correct the network)"},
        {lane("3", "95", "0,-1e9 0,-5"), R"(long, more than 100000 m; correct the network)"},
        {lane("1e9", "95", line), R"(wide, more than 1000 m; correct the network)"}}) {
    EXPECT_THAT(
        error_of(crossing(text, "")),
        MatchesRegex(std::string(R"(.*/test\.net\.xml:6: lane "sJ_0" is 1e\+09 m )") + message));
  }
  EXPECT_THAT(error_of(crossing(lane("3", "95", "1e300,0 1e300,1"), "")),
              MatchesRegex(R"(.*:6: lane "sJ_0" lies at \(1e\+300, 0\), more than 1e\+08 m .*)"));
  EXPECT_EQ(error_of(crossing(lane("3", "99000", "0,-99000 0,-5"), "")), "");
  std::string huge = crossing(kOpenLane, "");
  const std::size_t shape = huge.find("shape=", huge.find("<junction id=\"J\""));
  huge.replace(shape, huge.find('"', shape + 7) - shape, "shape=\"0,0 1e9,0 0,1e9");
  EXPECT_THAT(error_of(huge),
              MatchesRegex(R"(.*: junction "J" is .* m around, more than 10000 m; .*)"));
}

TEST(ReadNetwork, CanBeGivenUp) {
  int calls = 0;
  const auto give_up = [&] {
    if (++calls == 5) throw Interruption();
  };
  EXPECT_THROW((void)read_network(project_file("networks/crossroads.net.xml"), give_up),
               Interruption);
}

TEST(ReadNetwork, ACircleOfInternalLanesIsAnErrorNotALoop) {
  EXPECT_THAT(error_of(crossing(kOpenLane, kStraightOn + R"(
                <connection from=":J_1" to="Jn" fromLane="0" toLane="0" via=":J_1_0"/>)")),
              MatchesRegex(R"(.*the internal lanes from "sJ_0" to "Jn_0" do not end: ":J_1_0")"));
}

TEST(ReadNetwork, OtherFilesAreRefusedInOneLine) {
  EXPECT_THAT(error_of("<routes/>"),
              MatchesRegex(R"(.*:1: the root element is <routes>, not <net>; give .*)"));
  EXPECT_THAT(error_of("<net/>"), MatchesRegex(R"(.*:1: a network without edges; .*)"));
  EXPECT_THAT(error_of("<net><edge"), MatchesRegex(R"(.*:1: not XML \(XML_.*\); give .*)"));
  EXPECT_THAT(error_of(""), MatchesRegex(R"(.*: not XML \(XML_ERROR_EMPTY_DOCUMENT\); give .*)"));
  EXPECT_THAT(error_of(std::string(100000, '\xff')), MatchesRegex(R"(.*: not XML .*)"));
  EXPECT_THAT(error_of(std::string("\0\x1f\x8b", 3)), MatchesRegex(R"(.*: not XML .*)"));
}

TEST(ReadNetwork, PathsThatAreNoFilesAreRefused) {
  EXPECT_EQ(message_of([] { return read_network("/nowhere.net.xml"); }),
            "/nowhere.net.xml: no such file; give the path of a SUMO network, *.net.xml");
  EXPECT_EQ(message_of([] { return read_network("/"); }),
            "/: not a file; give the path of a SUMO network, *.net.xml");
  const TemporaryDirectory directory;
  EXPECT_THAT(message_of([&] { return read_network(directory.write("a.net.xml.gz", "")); }),
              MatchesRegex(".*/a.net.xml.gz:0: not XML .*"));
}

TEST(ReadNetwork, CompressedNetworksAreRead) {
  const TemporaryDirectory directory;
  const std::string packed = directory / "crossroads.net.xml.gz";
  const std::string command =
      "gzip -c '" + project_file("networks/crossroads.net.xml") + "' > '" + packed + "'";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(read_network(packed).lanes.size(), crossroads().lanes.size());
}

}  // namespace
}  // namespace mvtp
