// What --faults and --assume-noise take, and what a run says of the faults.
#include <tinyxml2.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/tools/program_fixture.hpp"

namespace mvtp {
namespace {

using nlohmann::json;

class CoordinateFaults : public Program {
 protected:
  /// The lane and the speed [m/s] of a vehicle at each step of the run; none: it is not there.
  void follow(const char* id, std::vector<std::string>& lanes, std::vector<double>& speeds) const {
    tinyxml2::XMLDocument document;
    ASSERT_EQ(document.LoadFile(directory_.path("out/fcd.xml").c_str()), tinyxml2::XML_SUCCESS);
    for (const auto* step = document.RootElement()->FirstChildElement("timestep"); step != nullptr;
         step = step->NextSiblingElement("timestep")) {
      const auto* vehicle = step->FirstChildElement("vehicle");
      while (vehicle != nullptr && !vehicle->Attribute("id", id)) {
        vehicle = vehicle->NextSiblingElement("vehicle");
      }
      lanes.emplace_back(vehicle == nullptr ? "" : vehicle->Attribute("lane"));
      speeds.push_back(vehicle == nullptr ? -1.0 : vehicle->DoubleAttribute("speed"));
    }
  }
};

TEST_F(CoordinateFaults, WrongOnesAreOneLine) {
  const std::string run =
      "coordinate -c '" + std::string(MVTP_SCENARIOS) + "/crossroads/crossroads.sumocfg' ";
  const std::string what = " a vehicle and a time from 0 on .s., ";
  for (const char* value : {"", "=", "=a", "=@5", "=a@", "=a@-1", "=a@nan", "=a@five", "=a@5s"}) {
    expect_refused(
        run + "--faults delay=0.1,stop" + value,
        std::string("--faults stop") + value + ": give stop" + what + "stop=VEHICLE@SECONDS");
  }
  expect_refused(run + "--faults ignore=a,delay=0.1",
                 "--faults ignore=a: give ignore" + what + "ignore=VEHICLE@SECONDS");
  for (const std::string option : {"--faults", "--assume-noise"}) {
    expect_refused(run + option + " dealy=1",
                   option + " dealy=1: is not a fault with a value; did you mean delay[?] [^\n]*");
    for (const char* delay : {"delay", "delay=", "delay=-1", "delay=11", "delay=nan", "delay=1s"}) {
      expect_refused(run + option + ' ' + delay,
                     option + ' ' + delay + ": give delay a number from 0 to 10");
    }
    expect_refused(run + option + " delay=1,loss=1",
                   option + " loss=1: give loss a number from 0 to 0.9");
  }
  expect_refused(run + "--faults stops=1.1", "--faults stops=1.1: give stops a number from 0 to 1");
  expect_refused(run + "--faults sumo-ends=-1",
                 "--faults sumo-ends=-1: give sumo-ends a number from 0 to [^\n]*");
  // What vehicles do by themselves cannot be planned for.
  for (const char* fault : {"stops=0.1", "stop=a@5", "ignores=0.1", "late=0.1", "sumo-ends=5"}) {
    expect_refused(run + "--assume-noise " + fault,
                   std::string("--assume-noise ") + fault +
                       ": is not a fault with a value; [^\n]*there are delay, loss, [^\n]*");
  }
  const std::string too_much =
      ": takes [0-9.]+ m between two vehicles side by side, and lanes leave 1.3 m; assume less "
      "noise";
  expect_refused(run + "--assume-noise position=5", "--assume-noise position=5" + too_much);
  expect_refused(run + "--faults position=5 --assume-noise faults",
                 "--assume-noise faults" + too_much);
}

// Frames count from the begin of the run, here 10 s.
TEST_F(CoordinateFaults, AVehicleThatStopsDeadIsInTheEventsWithItsFrame) {
  (void)directory_.file("crossroads.net.xml",
                        content_of(std::string(MVTP_NETWORKS) + "/crossroads.net.xml"));
  (void)directory_.file("stop.rou.xml",
                        R"(<routes><vType id="car" length="4.5"/>
                           <vehicle id="a" type="car" depart="12"><route edges="Wi Eo"/></vehicle>
                           <vehicle id="b" type="car" depart="40"><route edges="Si No"/></vehicle>
                           </routes>)");
  (void)directory_.file("stop.sumocfg",
                        R"(<configuration><net-file value="crossroads.net.xml"/>
                           <route-files value="stop.rou.xml"/><begin value="10"/>
                           <step-length value="0.1"/></configuration>)");
  // a stops in its passage, at about 35 s; b is through long before its time comes.
  const Outcome outcome =
      run("coordinate -c stop.sumocfg --faults stop=a@20.5,stop=b@2000,stops-for=5 --quiet");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const json faults = json::parse(content_of(directory_.path("out/summary.json")))["faults"];
  EXPECT_EQ(faults["simulated"], "stop=a@20.5,stop=b@2000,stops-for=5");
  ASSERT_EQ(faults["events"].size(), 1U);
  const json& event = faults["events"][0];
  EXPECT_EQ(event["vehicle"], "a");
  EXPECT_EQ(event["what"], "stops dead");
  EXPECT_NEAR(event["time_s"], 10.0 + 0.1 * event["frame"].get<int>(), 1e-6);
  ASSERT_EQ(faults["given_up"].size(), 1U);
  EXPECT_GT(faults["given_up"][0]["frame"], event["frame"]);
  EXPECT_EQ(faults["contacts"].size(), 0U);

  // At this frame it is inside the junction, and brakes from then on until it stands.
  std::vector<std::string> lanes;
  std::vector<double> speeds;
  follow("a", lanes, speeds);
  const auto frame = event["frame"].get<std::size_t>();
  ASSERT_LT(frame + 40, speeds.size());
  EXPECT_TRUE(lanes[frame].starts_with(":C")) << lanes[frame];
  EXPECT_GT(speeds[frame - 1], 10.0);
  for (std::size_t k = frame; k < frame + 20; ++k) EXPECT_LT(speeds[k], speeds[k - 1]) << k;
  EXPECT_EQ(speeds[frame + 40], 0.0);
}

}  // namespace
}  // namespace mvtp
