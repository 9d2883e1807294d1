// What is said before a run of what is not coordinated, or not as its author may think.
#include <sstream>
#include <vector>

#include "tests/tools/coordinate_run_fixture.hpp"

namespace mvtp {
namespace {

using testing::IsEmpty;

/// A scenario of which something is to be said before it runs, and what.
struct Noted {
  const char* line;           ///< empty: nothing
  const char* demand = "";    ///< beside a car
  const char* settings = "";  ///< in the configuration
  const char* options = "";   ///< behind "--"
  const char* net = "";       ///< another network
};

constexpr const char* kSublane =
    "lateral-resolution: SUMO's sublane model moves only vehicles that";
constexpr const char* kRerouters = "rerouters: a coordinated vehicle takes its new route once";
constexpr const char* kDevice = "device.rerouting: a coordinated vehicle takes its new route once";
constexpr const char* kPeople = "people on foot: coordinated vehicles keep clear of them";

const std::vector<Noted> kCases = {
    {.line = ""},
    {.line = "left-hand traffic: tried little", .net = "left.net.xml"},
    {.line = "overtaking in the opposite lane: such vehicles are not", .net = "opposite.net.xml"},
    {.line = "time-to-teleport 300: nobody is teleported here",
     .settings = "<time-to-teleport value=\"300\"/>"},
    {.line = "", .settings = "<time-to-teleport value=\"-1\"/>"},
    {.line = kSublane, .settings = "<lateral-resolution value=\"0.8\"/>"},
    {.line = kSublane, .options = "--lateral-resolution 0.8"},
    {.line = kSublane, .options = "--lateral-resolution=0.8"},
    {.line = "",
     .settings = "<lateral-resolution value=\"0.8\"/>",
     .options = "--lateral-resolution 0"},
    {.line = kRerouters, .settings = "<additional-files value=\"r.add.xml\"/>"},
    {.line = kRerouters, .settings = "<additional-files value=\"r.add.xml.gz\"/>"},
    {.line = kRerouters, .options = "--additional-files r.add.xml"},
    {.line = kRerouters, .options = "-a r.add.xml.gz"},
    {.line = kDevice,
     .settings =
         "<device.rerouting.probability value=\"1\"/><device.rerouting.period value=\"5\"/>"},
    {.line = kDevice, .options = "--device.rerouting.explicit a --device.rerouting.period 5"},
    {.line = kDevice,
     .demand = "<vType id=\"n\"><param key=\"has.rerouting.device\" value=\"true\"/>"
               "<param key=\"device.rerouting.period\" value=\"5\"/></vType>"},
    {.line = "", .settings = "<device.rerouting.probability value=\"1\"/>"},  // before it departs
    {.line = kPeople, .demand = "<person id=\"p\" depart=\"9\"><walk edges=\"Wi\"/></person>"},
    {.line = kPeople, .options = "--route-files p.rou.xml.gz"},
    {.line = "vehicles of type x (bicycle) are left to SUMO",
     .demand = "<vType id=\"x\" vClass=\"bicycle\"/>"},
    {.line = "vehicles of type x (tram) are left to SUMO",
     .demand = "<vType id=\"x\" vClass=\"tram\"/>"},
    {.line = "vehicles of type x (rail_urban) are left to SUMO",
     .demand = "<vType id=\"x\" vClass=\"rail_urban\"/>"},
    {.line = "vehicles of type x (ship) are left to SUMO",
     .demand = "<vType id=\"x\" vClass=\"ship\"/>"},
};

class CoordinateNotes : public CoordinateRun {
 protected:
  /// Networks and files that the cases name.
  void write_files() const {
    const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
      const std::size_t at = text.find(from);
      EXPECT_NE(at, std::string::npos) << from;
      return at == std::string::npos ? text : text.replace(at, from.size(), to);
    };
    const std::string net = content_of(kNet);
    (void)directory_.file("left.net.xml", replaced(net, "<net ", "<net lefthand=\"true\" "));
    const std::string lane = "shape=\"-300.00,-1.60 -7.20,-1.60\"";
    (void)directory_.file("opposite.net.xml",
                          replaced(net, lane + "/>", lane + "><neigh lane=\"Wo_0\"/></lane>"));
    const std::string rerouter =
        "<additional><rerouter id=\"r\" edges=\"Wi\"><interval begin=\"0\" end=\"9\">"
        "<destProbReroute id=\"So\"/></interval></rerouter></additional>";
    (void)directory_.file("r.add.xml", rerouter);
    (void)directory_.file(
        "p.rou.xml",
        "<routes><person id=\"p\" depart=\"9\"><walk edges=\"Wi\"/></person></routes>");
    ASSERT_EQ(shell("gzip -k r.add.xml p.rou.xml").exit_code, 0);
  }
};

TEST_F(CoordinateNotes, WhatIsNotCoordinatedIsSaidBefore) {
  write_files();
  for (const Noted& c : kCases) {
    SCOPED_TRACE(std::string(c.line) + ' ' + c.demand + c.settings + c.options);
    write(c.demand + vehicle("a", 0, "Wi Eo"), kStep + c.settings, *c.net == '\0' ? kNet : c.net);
    const Outcome outcome = coordinate("--end 0.1 --no-fcd --quiet" +
                                       (*c.options == '\0' ? "" : " -- " + std::string(c.options)));
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;  // not everybody has arrived
    std::vector<std::string> notes;
    std::stringstream lines(outcome.err);
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("mvtp: note: ") && line.find("SUMO warned") == std::string::npos) {
        notes.push_back(line);
      }
    }
    if (*c.line == '\0') {
      EXPECT_THAT(notes, IsEmpty());
    } else {
      EXPECT_THAT(notes,
                  testing::ElementsAre(testing::StartsWith("mvtp: note: " + std::string(c.line))));
    }
  }
  expect_refused("coordinate -c x.sumocfg -- --time-to-teleport 300",
                 "SUMO option --time-to-teleport: this program sets it itself [^\n]*");
}

}  // namespace
}  // namespace mvtp
