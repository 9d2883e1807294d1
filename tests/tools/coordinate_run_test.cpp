// What a run makes of scenarios that are unusual, and of ends that come early.
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/tools/coordinate_run_fixture.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

using nlohmann::json;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST_F(CoordinateRun, ALongStepIsReplacedAndSaid) {
  write(vehicle("a", 0, "Wi Eo"));  // SUMO's own default: 1 s
  const Outcome outcome = coordinate();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("mvtp: note: SUMO runs at steps of 0.1 s, not the scenario's "
                                     "1 s\n"));
  EXPECT_THAT(content_of(directory_.path("out/fcd.xml")), HasSubstr("time=\"0.10\""));
}

TEST_F(CoordinateRun, ALateBeginIsNotStuck) {
  write(vehicle("a", 25300, "Wi Eo"), kStep + "<begin value=\"25200\"/>");
  const Outcome outcome = coordinate("--junction C -- --no-internal-links false");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(summary()["completed"], 1);
  EXPECT_LT(summary()["simulated_s"], 300.0);
}

TEST_F(CoordinateRun, TheEndOfTheScenarioHoldsUnlessAnotherIsGiven) {
  write(vehicle("a", 0, "Wi Eo"), kStep + "<end value=\"20\"/>");
  EXPECT_EQ(coordinate().exit_code, 1);
  EXPECT_EQ(summary()["status"], "end reached");
  EXPECT_NEAR(summary()["simulated_s"], 20.0, 0.11);
  EXPECT_EQ(coordinate("-- --end 15").exit_code, 1);
  EXPECT_NEAR(summary()["simulated_s"], 15.0, 0.11);
  EXPECT_EQ(coordinate("--end 100").exit_code, 0);
  EXPECT_EQ(summary()["status"], "finished");
}

// SUMO's own word for "until everybody has arrived", which looks like an option.
TEST_F(CoordinateRun, ANegativeEndIsNone) {
  write(vehicle("a", 0, "Wi Eo"), kStep + "<end value=\"5\"/>");
  for (const char* end : {"--end -1", "--end=-1", "-e -1"}) {
    const Outcome outcome = coordinate(std::string("-- ") + end);
    EXPECT_EQ(outcome.exit_code, 0) << end << ": " << outcome.err;
    EXPECT_EQ(summary()["completed"], 1) << end;
  }
}

TEST_F(CoordinateRun, ARunWithoutAVehicleIsNoSuccess) {
  write("", kStep);
  Outcome outcome = coordinate("--quiet");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, testing::MatchesRegex("mvtp: no vehicle departed [^\n]*empty[^\n]*\n"));
  write(vehicle("a", 500, "Wi Eo"), kStep);
  outcome = coordinate("--quiet --end 10");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("no vehicle departed until t = 10.00 s"));
}

TEST_F(CoordinateRun, AScheduledStopIsNeitherStuckNorDelay) {
  write(vehicle("bus", 0, "Wi Eo", "<stop lane=\"Eo_0\" endPos=\"150\" duration=\"400\"/>"), kStep);
  const Outcome outcome = coordinate();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(summary()["status"], "finished");
  EXPECT_LT(summary()["delay_s"]["mean"], 20.0);
}

//   The first stands where the second would depart.
TEST_F(CoordinateRun, WhoCannotDepartDoesNotEndTheRun) {
  write(vehicle("a", 0, "Wi Eo", "<stop lane=\"Wi_0\" endPos=\"6\" duration=\"400\"/>") +
            vehicle("b", 1, "Wi Eo"),
        kStep);
  const Outcome outcome = coordinate("--end 20");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(summary()["status"], "end reached") << outcome.err;
  EXPECT_EQ(summary()["never_departed"], 1);
}

// SUMO's trips name the type of who never departed, and SUMO has ended when they are read.
TEST_F(CoordinateRun, TypesOfThoseWhoNeverDepartedAreKnown) {
  write("<vType id=\"rare\" length=\"6\"/>" + vehicle("a", 0, "Wi Eo") +
            "<vehicle id=\"b\" type=\"rare\" depart=\"0\"><route edges=\"Wi Eo\"/></vehicle>",
        kStep);
  const Outcome outcome = coordinate("--end 0.5");
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_EQ(summary()["status"], "end reached") << outcome.err;
  EXPECT_EQ(summary()["never_departed"], 1);
}

TEST_F(CoordinateRun, ARunInWhichNobodyMovesIsStuck) {
  write(
      "<vType id=\"snail\" maxSpeed=\"0.01\"/><vehicle id=\"a\" type=\"snail\" depart=\"0\"><route "
      "edges=\"Wi Eo\"/></vehicle>",
      kStep);
  const Outcome outcome = coordinate("--controller sumo");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(summary()["status"], "stuck");
  EXPECT_NEAR(summary()["simulated_s"], 300.0, 1.0);
}

TEST_F(CoordinateRun, AnErrorLateInTheRunKeepsWhatWasSimulated) {
  write(vehicle("a", 0, "Wi Eo") + vehicle("b", 500, "Wi Eo") + vehicle("c", 900, "Wi Atlantis"),
        kStep);
  const Outcome outcome = coordinate("--quiet");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, ContainsRegex("mvtp: x.sumocfg: SUMO stopped after [^\n]*Atlantis"));
  EXPECT_EQ(summary()["status"], "failed");
  EXPECT_THAT(summary()["message"], HasSubstr("Atlantis"));
  EXPECT_EQ(summary()["completed"], 1);
  EXPECT_TRUE(is_xml("out/fcd.xml"));
  EXPECT_TRUE(is_xml("out/tripinfo.xml"));
  EXPECT_FALSE(fs::exists(directory_.path("out/summary.json.part")));
}

TEST_F(CoordinateRun, ACrashKeepsTheLastCheckpoint) {
  const std::string script =
      std::string("'") + MVTP_PROGRAM + "' coordinate -c '" + kBusy + "' --quiet & pid=$!\n" +
      "until [ -f out/summary.json.part ]; do [ -d /proc/$pid ] || exit 99; sleep 0.01; done\n"
      "read -r sumo < /proc/$pid/task/$pid/children\nkill -ABRT $sumo; wait $pid; exit $?";
  const Outcome outcome = shell(script);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, ContainsRegex("mvtp: coordinate: the simulation crashed .Aborted.; "
                                         "[^\n]*/out holds what was simulated before\n"));
  const json s = summary();
  EXPECT_EQ(s["status"], "failed");
  EXPECT_EQ(s["message"], "the simulation crashed (Aborted)");
  EXPECT_GE(s["simulated_s"], 60.0);
  EXPECT_GT(s["vehicles"], 10);
  EXPECT_THAT(content_of(directory_.path("out/vehicles.csv")), HasSubstr("W-left.0,car,"));
  EXPECT_TRUE(is_xml("out/fcd.xml"));
  EXPECT_TRUE(is_xml("out/tripinfo.xml"));
  for (const auto& entry : fs::directory_iterator(directory_.path("out"))) {
    EXPECT_NE(entry.path().extension(), ".part") << entry.path();
  }
}

TEST_F(CoordinateRun, NobodySurvivesTheProgram) {
  const std::string script =
      std::string("'") + MVTP_PROGRAM + "' coordinate -c '" + kBusy + "' --quiet & pid=$!\n" +
      "until [ -n \"$(find out -name fcd.xml.part -size +100k 2>/dev/null)\" ]; do\n"
      "  [ -d /proc/$pid ] || exit 99; sleep 0.01; done\n"
      "read -r sumo < /proc/$pid/task/$pid/children\nkill -KILL $pid\n"
      "n=0; while [ -d /proc/$sumo ] && [ $n -lt 400 ]; do sleep 0.05; n=$((n + 1)); done\n"
      "[ ! -d /proc/$sumo ]; exit $?";
  EXPECT_EQ(shell(script).exit_code, 0);
  EXPECT_EQ(summary()["status"], "interrupted");
}

//   SUMO waits for who reads its summary, and so there is no step before that, however fast or slow
//   the machine is.
TEST_F(CoordinateRun, OneSignalDuringThePreparationLeavesNothingBehind) {
  write(vehicle("a", 0, "Wi Eo"), kStep);
  const std::string script =
      "mkdir out; echo old >out/summary.json; mkfifo gate\n" + std::string("'") + MVTP_PROGRAM +
      "' coordinate -c x.sumocfg -- --summary-output gate & pid=$!\n"
      "until [ -f out/sumo.log.part ]; do [ -d /proc/$pid ] || exit 99; sleep 0.01; done\n"
      "read -r sumo < /proc/$pid/task/$pid/children\nkill -INT $sumo\n"
      "cat gate >/dev/null & reader=$!; wait $pid; code=$?; kill $reader 2>/dev/null\n"
      "[ ! -d /proc/$sumo ] || exit 98; exit $code";
  const Outcome outcome = shell(script);
  EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
  EXPECT_THAT(outcome.err, IsEmpty());
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_EQ(content_of(directory_.path("out/summary.json")), "old\n");
  EXPECT_EQ(shell("ls -A out").out, "summary.json\n");
}

TEST_F(CoordinateRun, AFolderInUseIsBadInput) {
  const std::string script =
      std::string("'") + MVTP_PROGRAM + "' coordinate -c '" + kBusy + "' --quiet & pid=$!\n" +
      "until [ -n \"$(find out -name fcd.xml.part -size +100k 2>/dev/null)\" ]; do\n"
      "  [ -d /proc/$pid ] || exit 99; sleep 0.01; done\n'" +
      MVTP_PROGRAM + "' coordinate -c '" + kBusy + "' --quiet; code=$?\n" +
      "[ -f out/fcd.xml.part ] || exit 98; kill -INT $pid; wait $pid; exit $code";
  const Outcome outcome = shell(script);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("mvtp: out: another run writes into it; choose another "
                                     "--output-dir\n"));
  EXPECT_EQ(summary()["status"], "interrupted");
}

//   No file can grow beyond so many blocks, as if the disk were full from there on.
TEST_F(CoordinateRun, AFileOfSumosThatIsCutOffIsNoneAndTheRestIsKept) {
  write(vehicle("a", 0, "Wi Eo"), kStep);
  const Outcome outcome = shell(std::string("trap '' XFSZ; ulimit -f 40; '") + MVTP_PROGRAM +
                                "' coordinate -c x.sumocfg --no-view --quiet --output-dir out");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err,
            "mvtp: out/fcd.xml: is cut off: is the disk full? Make room, or choose "
            "another directory\n");
  EXPECT_FALSE(fs::exists(directory_.path("out/fcd.xml")));
  EXPECT_TRUE(is_xml("out/tripinfo.xml"));
  EXPECT_EQ(summary()["status"], "failed");
  EXPECT_EQ(summary()["completed"], 1);
}

//   Who has not arrived when a run fails is no second fault of it.
TEST_F(CoordinateRun, ARunThatFailsSaysSoInOneLine) {
  write(vehicle("a", 0, "Wi Eo"), kStep + "<end value=\"20\"/>");
  const Outcome outcome = shell(std::string("trap '' XFSZ; ulimit -f 40; '") + MVTP_PROGRAM +
                                "' coordinate -c x.sumocfg --no-view --quiet --output-dir out");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, testing::MatchesRegex("mvtp: out/fcd.xml: is cut off[^\n]*\n"));
  EXPECT_EQ(summary()["completed"], 0);
}

TEST_F(CoordinateRun, APageThatCannotBeWrittenIsTheOnlyLoss) {
  write(vehicle("a", 0, "Wi Eo"), kStep);
  const Outcome outcome = shell(std::string("trap '' XFSZ; ulimit -f 40; '") + MVTP_PROGRAM +
                                "' coordinate -c x.sumocfg --no-fcd --quiet --output-dir out");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, testing::MatchesRegex("mvtp: out/view.html[^\n]*\n"));
  EXPECT_FALSE(fs::exists(directory_.path("out/view.html")));
  EXPECT_EQ(summary()["status"], "finished");
}

TEST_F(CoordinateRun, WithoutRoomForTheSummaryNothingIsLeft) {
  write(vehicle("a", 0, "Wi Eo"), kStep);
  const Outcome outcome = shell(std::string("trap '' XFSZ; ulimit -f 1; '") + MVTP_PROGRAM +
                                "' coordinate -c x.sumocfg --no-view --quiet --output-dir out");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, testing::MatchesRegex("mvtp: out/summary.json[^\n]*\n"));
  EXPECT_TRUE(fs::is_empty(directory_.path("out")));
}

TEST_F(CoordinateRun, WarningsOfSumoAreToldAndKept) {
  // SUMO drops what is not sorted by departure.
  write(vehicle("a", 300, "Wi Eo") + vehicle("b", 0, "Wi Eo"), kStep);
  const Outcome outcome = coordinate("--quiet");
  EXPECT_THAT(outcome.err, ContainsRegex("mvtp: note: SUMO warned 1 times, see out/sumo.log; "
                                         "first: Route file should be sorted"));
  EXPECT_EQ(summary()["sumo_warnings"], 1);
  EXPECT_THAT(content_of(directory_.path("out/sumo.log")), HasSubstr("sorted"));
}

TEST_F(CoordinateRun, OutputsOfTheScenarioAreWrittenToo) {
  write(vehicle("a", 0, "Wi Eo"),
        kStep +
            "<fcd-output value=\"mine.xml\"/><tripinfo-output value=\"trips.xml\"/>"
            "<summary-output value=\"sums.xml\"/><output-prefix value=\"run1-\"/>");
  const Outcome outcome = coordinate();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, Not(HasSubstr("note")));
  for (const char* name :
       {"run1-mine.xml", "run1-trips.xml", "run1-sums.xml", "out/fcd.xml", "out/tripinfo.xml"}) {
    EXPECT_TRUE(is_xml(name)) << name;
  }
  EXPECT_EQ(summary()["completed"], 1);
}

TEST_F(CoordinateRun, CompressedNetworksAreRead) {
  const std::string command =
      "gzip -c '" + kNet + "' > '" + directory_.path("net.net.xml.gz") + "'";
  ASSERT_EQ(std::system(command.c_str()), 0);
  write(vehicle("a", 0, "Wi Eo"), kStep, "net.net.xml.gz");
  EXPECT_EQ(coordinate().exit_code, 0);
}

TEST_F(CoordinateRun, ScenariosForOtherClientsAreRefused) {
  for (const char* option :
       {"remote-port value=\"8813\"", "num-clients value=\"2\"", "mesosim value=\"true\""}) {
    write(vehicle("a", 0, "Wi Eo"), kStep + "<" + option + "/>");
    const std::string name(option, std::string(option).find(' '));
    expect_refused("coordinate -c x.sumocfg", "x.sumocfg: " + name + " [^\n]*; leave it out");
  }
}

TEST_F(CoordinateRun, ListsOfJunctionsMayBeFollowedByOptions) {
  write(vehicle("a", 0, "Wi Eo"), kStep);
  const Outcome outcome = coordinate("--junction C --junction W,E -- --begin 0");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  expect_refused("coordinate -c x.sumocfg --junction C,c1",
                 "--junction c1: the network has no junction with this id; there is C");
}

/// Two small parking lots, and a crossing far from both; two cars come to each.
class LotsAndJunction : public CoordinateRun {
 protected:
  void make() const {
    std::string nodes = "<nodes>";
    std::string edges = "<edges>";
    std::string connections = "<connections>";
    std::string lots = "<additional>";
    std::string demand = "<routes><vType id=\"car\" length=\"4.5\" width=\"1.8\"/>";
    for (const int lot : {0, 1}) {
      const std::string n = std::to_string(lot);
      const int y = 200 * lot;
      nodes +=
          node("in" + n, -100, y + 3) + node("gate" + n, 0, y + 8) + node("out" + n, -100, y + 13);
      edges += edge("entry" + n, "in" + n, "gate" + n, at(-100, y + 3) + ' ' + at(0, y + 3)) +
               edge("exit" + n, "gate" + n, "out" + n, at(0, y + 13) + ' ' + at(-100, y + 13));
      lots += "<poly id=\"lot" + n + "\" type=\"parking.ground\" shape=\"" +
              line(y, {-28, 1,  0,   1,  0,   0,  30, 0,  30, 22, 0,   22,
                       0,   15, -28, 15, -28, 11, 0,  11, 0,  5,  -28, 5}) +
              "\"/><parkingArea id=\"lot" + n + "\" lane=\"entry" + n +
              "_0\" startPos=\"85\" endPos=\"95\">";
      connections += "<connection from=\"entry" + n + "\" to=\"exit" + n +
                     "\" fromLane=\"0\" toLane=\"0\" shape=\"" +
                     line(y, {0, 3, -4, 5, -6, 8, -4, 11, 0, 13}) + "\"/>";
      for (const int x : {12, 15, 18}) {
        lots += "<space x=\"" + std::to_string(x) + "\" y=\"" + std::to_string(y + 22) +
                "\" angle=\"180\" width=\"3\" length=\"5.5\"/>";
      }
      lots += "</parkingArea>";
      for (const int k : {0, 1}) {
        demand += "<vehicle id=\"p" + n + std::to_string(k) + "\" type=\"car\" depart=\"" +
                  std::to_string(20 * lot + 10 * k) + "\"><route edges=\"entry" + n + " exit" + n +
                  "\"/><stop parkingArea=\"lot" + n + "\" duration=\"60\"/></vehicle>";
      }
    }
    nodes += node("W", -150, 600) + node("E", 150, 600) + node("S", 0, 450) + node("N", 0, 750) +
             node("C", 0, 600) + "</nodes>";
    edges += edge("we", "W", "C") + edge("ee", "C", "E") + edge("sn", "S", "C") +
             edge("nn", "C", "N") + "</edges>";
    demand += vehicle("x", 40, "we ee") + vehicle("y", 40, "sn nn") + "</routes>";
    (void)directory_.file("x.nod.xml", nodes);
    (void)directory_.file("x.edg.xml", edges);
    (void)directory_.file("x.con.xml", connections + "</connections>");
    (void)directory_.file("x.add.xml", lots + "</additional>");
    (void)directory_.file("x.rou.xml", demand);
    (void)directory_.file("x.sumocfg",
                          "<configuration><net-file value=\"x.net.xml\"/><route-files "
                          "value=\"x.rou.xml\"/><additional-files value=\"x.add.xml\"/>" +
                              kStep + "</configuration>");
    const Outcome outcome = shell(
        "netconvert -n x.nod.xml -e x.edg.xml -x x.con.xml -o x.net.xml --no-turnarounds "
        "--offset.disable-normalization");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }

 private:
  static std::string at(int x, int y) { return std::to_string(x) + ',' + std::to_string(y); }
  /// Points x, y, x, y, ..., moved by `up`.
  static std::string line(int up, const std::vector<int>& numbers) {
    std::string text;
    for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) {
      text += (i == 0 ? "" : " ") + at(numbers[i], numbers[i + 1] + up);
    }
    return text;
  }
  static std::string node(const std::string& id, int x, int y) {
    return "<node id=\"" + id + "\" x=\"" + std::to_string(x) + "\" y=\"" + std::to_string(y) +
           "\" type=\"priority\"/>";
  }
  static std::string edge(const std::string& id, const std::string& from, const std::string& to,
                          const std::string& shape = "") {
    return "<edge id=\"" + id + "\" from=\"" + from + "\" to=\"" + to + "\" speed=\"8\"" +
           (shape.empty() ? "" : " spreadType=\"center\" shape=\"" + shape + "\"") + "/>";
  }
};

TEST_F(LotsAndJunction, AreCoordinatedInOneRun) {
  make();
  const Outcome outcome = coordinate("--quiet");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const json s = summary();
  EXPECT_EQ(s["completed"], 6);
  EXPECT_EQ(s["parking"]["lot"], "lot0, lot1");
  EXPECT_EQ(s["parking"]["lots"].size(), 2U);
  EXPECT_EQ(s["parking"]["gate_to_parked_s"]["vehicles"], 4);
  ASSERT_EQ(s["zones"].size(), 1U);
  EXPECT_EQ(s["zones"][0]["junctions"], json::array({"C"}));
  const std::string vehicles = content_of(directory_.path("out/vehicles.csv"));
  for (const char* id : {"p00", "p01", "p10", "p11", "x", "y"}) {
    EXPECT_THAT(vehicles, ContainsRegex("\n" + std::string(id) + ",car,.*,1,")) << id;
  }
  for (const char* name : {"lot.svg", "lot2.svg", "visits.csv", "occupancy.csv"}) {
    EXPECT_TRUE(fs::exists(directory_.path(std::string("out/") + name))) << name;
  }
}

TEST_F(CoordinateRun, AClosingTableAndTheProgressUnlessQuiet) {
  write(vehicle("a", 0, "Wi Eo"), kStep);
  Outcome outcome = coordinate();
  EXPECT_THAT(outcome.out, ContainsRegex("control +runs +delay .*\nescot +1/1 .* 1/1 "));
  EXPECT_THAT(outcome.err, HasSubstr("coordinate: 10 %, "));
  write(vehicle("a", 0, "Wi Eo"), kStep + "<duration-log.statistics value=\"true\"/>");
  outcome = coordinate("--quiet");
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(outcome.err, IsEmpty());
}

TEST_F(CoordinateRun, DecisionsAreDumpedAsInstances) {
  write(vehicle("a", 0, "Wi Eo") + vehicle("b", 0, "Si No"), kStep);
  EXPECT_EQ(coordinate("--dump-instances a/dump --dump-every 5").exit_code, 0);
  int solved = 0;
  for (const auto& file : fs::directory_iterator(directory_.path("a/dump"))) {
    const std::string name = "a/dump/" + file.path().filename().string();
    EXPECT_EQ(run("solve -i " + name + " -o plan.yaml").exit_code, 0) << name;
    EXPECT_EQ(run("validate -i " + name + " -s plan.yaml").exit_code, 0) << name;
    ++solved;
  }
  EXPECT_GE(solved, 2);
  expect_refused("coordinate -c x.sumocfg --dump-instances b --controller sumo",
                 "--dump-instances: dumps decisions at junctions, [^\n]*");
}

}  // namespace
}  // namespace mvtp
