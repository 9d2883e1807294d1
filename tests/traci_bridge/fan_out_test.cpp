// Onto which lane drivers go where several lead on, and which signals they heed who are let
// through; netconvert makes the network.
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <string>

#include "tests/traci_bridge/sumo_traffic_fixture.hpp"

namespace mvtp {
namespace {

/// One lane to the east that leads onto each of three, of which each leads to another road; with
/// a signal at the second junction, if wanted.
class FanOut : public testing::Test {
 protected:
  std::unique_ptr<SumoTraffic> open(const std::string& vehicles,
                                    const std::string& second = "priority") {
    directory_.write("x.nod.xml", R"(<nodes>
      <node id="w" x="0" y="0"/><node id="a" x="150" y="0"/>
      <node id="b" x="300" y="0" type=")" +
                                      second + R"("/>
      <node id="n" x="300" y="150"/><node id="e" x="450" y="0"/><node id="s" x="300" y="-150"/>
      </nodes>)");
    directory_.write("x.edg.xml", R"(<edges>
      <edge id="wa" from="w" to="a" numLanes="1"/><edge id="ab" from="a" to="b" numLanes="3"/>
      <edge id="bn" from="b" to="n"/><edge id="be" from="b" to="e"/>
      <edge id="bs" from="b" to="s"/></edges>)");
    directory_.write("x.con.xml", R"(<connections>
      <connection from="wa" to="ab" fromLane="0" toLane="0"/>
      <connection from="wa" to="ab" fromLane="0" toLane="1"/>
      <connection from="wa" to="ab" fromLane="0" toLane="2"/>
      <connection from="ab" to="bs" fromLane="0" toLane="0"/>
      <connection from="ab" to="be" fromLane="1" toLane="0"/>
      <connection from="ab" to="bn" fromLane="2" toLane="0"/></connections>)");
    const std::string here = directory_ / "x";
    const std::string command = "netconvert -n " + here + ".nod.xml -e " + here + ".edg.xml -x " +
                                here + ".con.xml -o " + here + ".net.xml > /dev/null 2>&1";
    if (std::system(command.c_str()) != 0) throw std::runtime_error("netconvert failed");
    directory_.write("x.rou.xml", R"(<routes><vType id="car"/>)" + vehicles + "</routes>");
    SumoOptions options;
    options.configuration =
        directory_.write("x.sumocfg", R"(<configuration><net-file value="x.net.xml"/>
          <route-files value="x.rou.xml"/><step-length value="0.1"/></configuration>)");
    return open_sumo(options);
  }

  TemporaryDirectory directory_;
};

TEST_F(FanOut, DriversGoOntoTheLaneThatTheyMeanToTake) {
  std::string vehicles;
  for (int i = 0; i < 12; ++i) {
    const char* const to[] = {"bs", "be", "bn"};
    vehicles += vehicle("v" + std::to_string(i), 4.0 * i, std::string("wa ab ") + to[i % 3]);
  }
  const auto traffic = open(vehicles);
  std::map<std::string, std::string> meant;
  std::map<std::string, int> met;
  while (traffic->running()) {
    traffic->step();
    for (const VehicleState& v : traffic->vehicles()) {
      if (v.lane == "wa_0") meant[v.id] = traffic->next_lane(v.id);
      if (v.lane.starts_with("ab_") && met.emplace(v.id, 0).second) {
        EXPECT_EQ(v.lane, meant.at(v.id)) << v.id;
      }
    }
  }
  EXPECT_EQ(met.size(), 12U);
}

// One line: the first, where there is no signal.
TEST_F(FanOut, WhoIsLetThroughOneLineHeedsTheSignalBehindIt) {
  const auto traffic = open(vehicle("none", 0.0, "wa ab bs") + vehicle("one", 0.0, "wa ab be") +
                                vehicle("all", 0.0, "wa ab bn"),
                            "traffic_light");
  const std::map<std::string, Passage> passages = {
      {"none", Passage::kNone}, {"one", Passage::kOneLine}, {"all", Passage::kAll}};
  std::map<std::string, std::string> edge;
  for (int i = 0; i < 600; ++i) {
    for (int light = 0; light < 3; ++light) traffic->show("b", light, Light::kRed);
    traffic->step();
    for (const VehicleState& v : traffic->vehicles()) {
      if (!edge.contains(v.id)) traffic->let_through(v.id, passages.at(v.id));
      if (!v.lane.starts_with(':')) edge[v.id] = v.lane.substr(0, 2);
    }
  }
  EXPECT_EQ(edge["none"], "ab");
  EXPECT_EQ(edge["one"], "ab");
  EXPECT_EQ(edge["all"], "bn");
}

TEST_F(FanOut, NobodyMeansToGoOnWhereTheRouteEnds) {
  const auto traffic = open(vehicle("v", 0.0, "wa"));
  run_until(*traffic, 2.0);
  EXPECT_EQ(traffic->next_lane("v"), "");
}

}  // namespace
}  // namespace mvtp
