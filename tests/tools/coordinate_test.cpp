#include <tinyxml2.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "tests/tools/program_fixture.hpp"
#include "tools/view/page.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

using nlohmann::json;
using testing::AllOf;
using testing::Contains;
using testing::ContainsRegex;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::Not;

const std::string kQuiet = std::string(MVTP_SCENARIOS) + "/crossroads/crossroads.sumocfg";
const std::string kBusy = std::string(MVTP_SCENARIOS) + "/crossroads/crossroads-400.sumocfg";

std::string configuration(const std::string& net, const std::string& routes = "") {
  return "<configuration><input><net-file value=\"" + net + "\"/>" +
         (routes.empty() ? "" : "<route-files value=\"" + routes + "\"/>") +
         "</input></configuration>";
}

class Coordinate : public Program {
 protected:
  [[nodiscard]] json summary(const std::string& folder = "out") const {
    const json result = json::parse(content_of(directory_.path(folder + "/summary.json")), nullptr,
                                    /*allow_exceptions=*/false);
    EXPECT_TRUE(result.is_object()) << folder;
    return result;
  }

  /// Parses a whole XML file and returns how many `element`s it has at its top level.
  [[nodiscard]] int elements_in(const std::string& file, const char* element) const {
    tinyxml2::XMLDocument document;
    EXPECT_EQ(document.LoadFile(directory_.path(file).c_str()), tinyxml2::XML_SUCCESS) << file;
    int count = 0;
    if (document.RootElement() == nullptr) return count;
    for (const auto* e = document.RootElement()->FirstChildElement(element); e != nullptr;
         e = e->NextSiblingElement(element)) {
      ++count;
    }
    return count;
  }

  /// Starts a long run in the background and goes on with `script` once it drives; $pid is mvtp,
  /// $sumo its child.
  [[nodiscard]] Outcome during_a_run(const std::string& script) const {
    return shell(std::string("'") + MVTP_PROGRAM + "' coordinate -c '" + kBusy + "' & pid=$!\n" +
                 "until [ -n \"$(find out -name fcd.xml.part -size +100k 2>/dev/null)\" ]; do\n"
                 "  [ -d /proc/$pid ] || exit 99; sleep 0.05; done\n"
                 "read -r sumo < /proc/$pid/task/$pid/children\n" +
                 script + "\nwait $pid; exit $?");
  }

  void expect_no_files_but(std::ptrdiff_t count) const {
    std::ptrdiff_t files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(directory_.path(""))) {
      files += entry.is_regular_file() ? 1 : 0;
    }
    EXPECT_EQ(files, count);
  }
};

TEST_F(Coordinate, AWindowNeedsADisplay) {
  const Outcome outcome = shell(std::string("unset DISPLAY WAYLAND_DISPLAY; '") + MVTP_PROGRAM +
                                "' coordinate -c '" + kBusy + "' --gui");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, testing::MatchesRegex("mvtp: --gui: there is no display [^\n]*\n"));
}

TEST_F(Coordinate, BrokenScenariosAreOneLine) {
  (void)directory_.file("empty.sumocfg", "");
  (void)directory_.file("garbage.sumocfg", std::string(10'000'000, '\x91'));
  (void)directory_.file("words.sumocfg", std::string(10'000'000, 'z'));
  (void)directory_.file("none.sumocfg", "<configuration/>");
  (void)directory_.file("lost.sumocfg", configuration("no.net.xml"));
  const std::string net = content_of(std::string(MVTP_NETWORKS) + "/crossroads.net.xml");
  (void)directory_.file("half.net.xml", net.substr(0, net.size() / 2));
  (void)directory_.file("half.sumocfg", configuration("half.net.xml"));
  (void)directory_.file("whole.net.xml", net);
  (void)directory_.file("routes.sumocfg", configuration("whole.net.xml", "bad.rou.xml"));
  (void)directory_.file("bad.rou.xml",
                        "<routes><vehicle id=\"a\" depart=\"0\"><route edges=\"nowhere\"/>"
                        "</vehicle></routes>");

  const auto run = [](const std::string& file) { return "coordinate --output-dir . -c " + file; };
  expect_refused("coordinate", "coordinate: --configuration is required; .*");
  expect_refused(run("missing.sumocfg"), "missing.sumocfg: no such file; give [^\n]*");
  expect_refused(run("."), "[.]: not a file; [^\n]*");
  expect_refused(run("/dev/zero"), "/dev/zero: not a file; [^\n]*");
  for (const char* name : {"empty", "garbage", "words"}) {
    expect_refused(run(std::string(name) + ".sumocfg"),
                   std::string(name) + "[.]sumocfg:[0-9]+: not XML [^\n]*");
  }
  expect_refused(run("none.sumocfg"), "none[.]sumocfg:1: no net-file in it; [^\n]*");
  expect_refused(run("lost.sumocfg"),
                 "lost[.]sumocfg:1: net-file: no[.]net[.]xml: no such file; [^\n]*");
  expect_refused(run("half.sumocfg"), "half[.]net[.]xml:[0-9]+: not XML [^\n]*");
  expect_refused(run("routes.sumocfg"),
                 "routes[.]sumocfg: SUMO does not start: [^\n]*nowhere[^\n]*");
  expect_no_files_but(10);
}

TEST_F(Coordinate, BadInputCostsNobodyHisResults) {
  ASSERT_EQ(shell("mkdir out; echo old >out/summary.json").exit_code, 0);
  expect_refused("coordinate -c missing.sumocfg", "missing.sumocfg: no such file; give [^\n]*");
  expect_refused("coordinate -c '" + kQuiet + "' --junction nowhere", "--junction nowhere: .*");
  expect_refused("coordinate -c '" + kQuiet + "' --remote localhost:1", "[^\n]*localhost:1[^\n]*");
  EXPECT_EQ(content_of(directory_.path("out/summary.json")), "old\n");
}

TEST_F(Coordinate, WrongOptionsAreOneLine) {
  const std::string run = "coordinate -c '" + kQuiet + "' ";
  const std::string help = "; see mvtp coordinate --help";
  expect_refused(run + "--fly", "coordinate: --fly was not expected" + help);
  expect_refused(run + "--controller magic",
                 "--controller magic: is no controller; there are escot, [^\n]*");
  for (const char* radius : {"-5", "nan", "inf", "1e9", "five"}) {
    expect_refused(run + "--zone-radius " + radius,
                   std::string("coordinate: --zone-radius: is \"") + radius +
                       "\"; give a number from 20 to 1000" + help);
  }
  expect_refused(
      run + "--max-lateral-accel 1e-9",
      "coordinate: --max-lateral-accel: is \"1e-9\"; give a number from 0.1 to 100, or 0" + help);
  expect_refused(run + "--seed -1", "coordinate: --seed: is \"-1\"; [^\n]*");
  expect_refused(run + "--break-down v@-5", "--break-down v@-5: is for parking lots, [^\n]*");
  expect_refused(run + "--end nan", "coordinate: --end: is \"nan\"; [^\n]*");
  for (const char* controller : {"escot", "sumo"}) {
    expect_refused(run + "--junction nowhere --controller " + controller,
                   "--junction nowhere: the network has no junction with this id; there is C");
  }
  expect_refused(run + "--penetration 1.5",
                 "coordinate: --penetration: is \"1.5\"; give a number from 0 to 1" + help);
  for (const char* option : {"--coordinate-types", "--human-types"}) {
    expect_refused(run + option + " cat", std::string(option) +
                                              " cat: the scenario has no vehicle type with this "
                                              "id; did you mean car[^\n]*");
  }
  expect_refused(run + "--coordinate-types car --human-types car",
                 "--human-types car: is named in --coordinate-types too; leave it out of one of "
                 "them");
  expect_refused(run + "-- --bogus 3",
                 "[^\n]*crossroads[.]sumocfg: SUMO does not start: [^\n]*bogus[^\n]*");
  expect_refused(run + "-- --seed 3", "SUMO option --seed: [^\n]*");
  expect_refused(run + "--end 60 -- --begin 100",
                 "[^\n]*crossroads[.]sumocfg: ends at t = 60 s, before it begins at t = 100 s; "
                 "[^\n]*");
  expect_refused(run + "-- --step-length 0.5",
                 "SUMO option --step-length: 0.5 s is too long [^\n]*");
  expect_refused(run + "-- --step-length=1", "SUMO option --step-length: 1 s is too long [^\n]*");
  expect_no_files_but(0);
}

TEST_F(Coordinate, UnwritableOutputIsOneLine) {
  (void)directory_.file("file", "");
  fs::create_directories(directory_.path("taken/fcd.xml"));
  fs::create_directories(directory_.path("taken2/summary.json"));
  const std::string run = "coordinate -c '" + kQuiet + "' --output-dir ";
  expect_refused(run + "''", "--output-dir: is empty; give a folder");
  expect_refused(run + "file", "file: cannot make this folder [^\n]*; choose [^\n]*");
  expect_refused(run + "/proc/mvtp", "/proc/mvtp: cannot make this folder [^\n]*");
  expect_refused(run + "/proc", "/proc/summary.json: cannot be written: [^\n]*");
  expect_refused(run + "taken", "taken/fcd.xml: cannot be written: it is a directory; [^\n]*");
  expect_refused(run + "taken2",
                 "taken2/summary.json: cannot be written: it is a directory; [^\n]*");
  expect_no_files_but(1);
}

TEST_F(Coordinate, AShortRunLeavesEveryFileAndEveryFigure) {
  const Outcome outcome = run("coordinate -c '" + kQuiet + "' --end 200 --quiet");
  EXPECT_EQ(outcome.exit_code, 1);  // some are still on their way
  EXPECT_THAT(outcome.err, MatchesRegex("mvtp: [0-9]+ of [0-9]+ vehicles had not arrived at t = "
                                        "200.00 s .end reached.\n"));
  EXPECT_THAT(outcome.out, IsEmpty());
  const json s = summary();
  for (const char* pointer : {"/vehicles",
                              "/completed",
                              "/throughput_veh_h",
                              "/delay_s/mean",
                              "/delay_s/p50",
                              "/delay_s/p95",
                              "/delay_s/max",
                              "/time_loss_s",
                              "/depart_delay_s",
                              "/waiting_time_s",
                              "/audit/overlap_pairs",
                              "/audit/overlap_pairs_coordinated",
                              "/audit/overlap_vehicle_steps",
                              "/audit/min_clearance_m",
                              "/audit/off_road_steps",
                              "/sumo_collisions",
                              "/max_accel",
                              "/max_decel",
                              "/max_lateral_accel",
                              "/max_curvature_ratio",
                              "/max_speed",
                              "/hard_brakings_after_handback",
                              "/replan_ms/p50",
                              "/replan_ms/p95",
                              "/replan_ms/p99",
                              "/replan_ms/max",
                              "/replans",
                              "/fallbacks",
                              "/real_time_factor",
                              "/seed"}) {
    ASSERT_TRUE(s.contains(json::json_pointer(pointer))) << pointer;
    EXPECT_TRUE(s[json::json_pointer(pointer)].is_number()) << pointer;
  }
  for (const char* key : {"sumo_version", "mvtp_version", "command", "status"}) {
    EXPECT_TRUE(s[key].is_string()) << key;
  }
  EXPECT_EQ(s["status"], "end reached");
  EXPECT_GT(s["vehicles"], 20);
  EXPECT_GT(s["replans"], 100);
  EXPECT_EQ(s["audit"]["overlap_pairs"], 0);
  EXPECT_EQ(elements_in("out/fcd.xml", "timestep"), 2000);
  EXPECT_GE(elements_in("out/tripinfo.xml", "tripinfo"), s["vehicles"]);
  for (const char* name : {"vehicles.csv", "replans.csv", "events.csv", "view.html"}) {
    EXPECT_FALSE(content_of(directory_.path(std::string("out/") + name)).empty()) << name;
  }
  expect_no_files_but(7);
}

/// What the page of a run says of it.
json page_of(const std::string& path) {
  return json::parse(replays_of(content_of(path), path).at(0).header);
}

std::vector<std::string> figures_of(const json& header) {
  std::vector<std::string> labels;
  for (const json& figure : header["figures"]) labels.push_back(figure[0]);
  return labels;
}

TEST_F(Coordinate, ThePageOfACoordinatedRunHasGroupsCorridorsAndEmissions) {
  ASSERT_EQ(
      run("coordinate -c '" + kBusy + "' --end 60 --penetration 0.8 --no-fcd --quiet").exit_code,
      1);  // not everybody has arrived
  const json page = page_of(directory_.path("out/view.html"));
  EXPECT_TRUE(page["groups"]);
  EXPECT_TRUE(page["emissions"]);
  EXPECT_GE(page["scene"]["corridors"].size(), 4U);
  EXPECT_THAT(figures_of(page), AllOf(Contains("status"), Contains("replan p95")));
  EXPECT_THAT(figures_of(page), Not(Contains("people touched")));
  std::set<bool> automated;
  for (const json& vehicle : page["vehicles"]) {
    automated.insert(vehicle["automated"].get<bool>());
    EXPECT_THAT(vehicle["movement"], MatchesRegex("[^>]+>[^>]+"));
  }
  EXPECT_EQ(automated.size(), 2U);
}

TEST_F(Coordinate, ThePageOfMixedTrafficHasTheTubesOfHumanDrivers) {
  const std::string signalised =
      std::string(MVTP_SCENARIOS) + "/crossroads/crossroads.static.sumocfg";
  const std::string command = "coordinate -c '" + signalised + "' --end 60 --no-fcd --quiet";
  (void)run(command + " --penetration 0.5");
  const json tubes = page_of(directory_.path("out/view.html"))["tubes"];
  ASSERT_TRUE(tubes.is_object());
  EXPECT_GE(tubes["paths"].size(), 4U);
  EXPECT_GE(tubes["forks"].size(), 4U);
  (void)run(command + " --penetration 1");
  EXPECT_TRUE(page_of(directory_.path("out/view.html"))["tubes"].is_null());
}

TEST_F(Coordinate, ThePageOfASignalHasItsLightsPeopleAndSidewalks) {
  const std::string people =
      std::string(MVTP_SCENARIOS) + "/crossroads/crossroads-people.static.sumocfg";
  ASSERT_EQ(
      run("coordinate -c '" + people + "' --controller sumo --end 60 --no-fcd --quiet").exit_code,
      1);
  const json page = page_of(directory_.path("out/view.html"));
  EXPECT_THAT(figures_of(page), AllOf(Contains("people touched"), Not(Contains("replan p95"))));
  ASSERT_EQ(page["signals"].size(), 1U);
  EXPECT_GE(page["signals"][0]["shown"].size(), 3U);
  EXPECT_GE(page["scene"]["lights"].size(), 12U);
  EXPECT_EQ(page["scene"]["crossings"].size(), 4U);
  const auto is_foot = [](const json& lane) { return lane["kind"] == "foot"; };
  EXPECT_TRUE(std::ranges::any_of(page["scene"]["lanes"], is_foot));
  const auto is_person = [](const json& vehicle) { return vehicle["person"].get<bool>(); };
  EXPECT_TRUE(std::ranges::any_of(page["vehicles"], is_person));
}

TEST_F(Coordinate, HumanDriversGetTheirGreensFromUs) {
  const std::string signalised =
      std::string(MVTP_SCENARIOS) + "/crossroads/crossroads.static.sumocfg";
  const Outcome mixed = run("coordinate -c '" + signalised +
                            "' --end 120 --penetration 0.5 --seed 1 --no-view --no-fcd --quiet");
  EXPECT_EQ(mixed.exit_code, 1) << mixed.err;  // cut off before all have arrived
  const json j = summary();
  EXPECT_EQ(j["penetration"], 0.5);
  EXPECT_EQ(j["audit"]["overlap_pairs"], 0);
  EXPECT_GT(j["delay_controlled_s"]["vehicles"], 0);
  EXPECT_GT(j["delay_human_s"]["vehicles"], 0);
  EXPECT_EQ(int(j["delay_controlled_s"]["vehicles"]) + int(j["delay_human_s"]["vehicles"]),
            j["vehicles"]);
  EXPECT_GT(j["greens"], 0);
  EXPECT_TRUE(j.contains("tube_misses"));
  EXPECT_TRUE(j.contains("unplanned_passages"));
}

TEST_F(Coordinate, SaysWhereHumanDriversHaveNoLight) {
  const auto says_so = [&](const std::string& scenario, const std::string& options) {
    const Outcome outcome = run("coordinate -c '" + std::string(MVTP_SCENARIOS) + "/crossroads/" +
                                scenario + "' --end 1 --no-view --no-fcd --quiet " + options);
    return outcome.err.find("note: no traffic light at C: human drivers") != std::string::npos;
  };
  EXPECT_TRUE(says_so("crossroads.sumocfg", "--penetration 0.5"));
  EXPECT_FALSE(says_so("crossroads.sumocfg", "--penetration 1"));
  EXPECT_FALSE(says_so("crossroads.static.sumocfg", "--penetration 0.5"));
}

TEST_F(Coordinate, SaysWhichOptionsHaveNoEffect) {
  const auto note_on = [&](const std::string& options) {
    const Outcome outcome = run("coordinate -c '" + std::string(MVTP_SCENARIOS) +
                                "/crossroads/crossroads.static.sumocfg' --end 1 --no-view "
                                "--no-fcd --quiet " +
                                options);
    const std::size_t note = outcome.err.find("note: --");
    if (note == std::string::npos) return std::string();
    return outcome.err.substr(note, outcome.err.find('\n', note) - note);
  };
  const std::string all = "--human-faults 0.1 --intent lane --signal-timing instant ";
  EXPECT_EQ(note_on(all),
            "note: --human-faults, --intent lane, --signal-timing instant: everybody is taken "
            "over; say with --penetration or --human-types who keeps a human driver");
  EXPECT_EQ(note_on(all + "--penetration 0.5"), "");
  EXPECT_EQ(note_on(all + "--human-types car"), "");
  EXPECT_EQ(note_on(all + "--controller static"), "");
  EXPECT_EQ(note_on("--intent known --signal-timing real"), "");
  EXPECT_EQ(note_on("--assume-noise faults"),
            "note: --assume-noise faults: without --faults there are none");
  EXPECT_EQ(note_on("--assume-noise faults --faults delay=0.1"), "");
}

TEST_F(Coordinate, PeopleCrossUntouched) {
  for (const char* light : {"", ".static"}) {
    const std::string scenario =
        std::string(MVTP_SCENARIOS) + "/crossroads/crossroads-people" + light + ".sumocfg";
    const Outcome outcome =
        run("coordinate -c '" + scenario + "' --end 200 --seed 1 --no-view --no-fcd --quiet");
    const json people = summary()["people"];
    EXPECT_GT(people["walked"], 5) << outcome.err;
    EXPECT_EQ(people["touched"], 0);
    EXPECT_LT(people["wait_s"], 15.0);
    EXPECT_EQ(people["greens"] > 0, *light != '\0');
  }
}

// Its right turns are as tight as cars can drive. Paths that swing into the lane beside stop it,
// and so do lorries that wait partly in it.
TEST_F(Coordinate, TheRilsaFlows) {
  for (const char* options : {"--seed 4", "--seed 1 --max-lateral-accel 3"}) {
    const Outcome outcome =
        run("coordinate -c '" + std::string(MVTP_SCENARIOS) + "/rilsa/rilsa.sumocfg' --end 150 " +
            "--no-view --no-fcd --quiet " + options);
    const json result = summary();
    EXPECT_EQ(result["overlap_pairs_coordinated"], 0) << outcome.err;
    EXPECT_EQ(result["audit"]["off_road_steps_coordinated"], 0);
    EXPECT_GT(result["completed"], 50);
    EXPECT_LT(result["delay_s"]["mean"], 7.0);
  }
}

TEST_F(Coordinate, TheSameCommandGivesTheSameVehicles) {
  const std::string arguments = "coordinate -c '" + kQuiet + "' --end 200 --seed 7 --no-view";
  (void)run(arguments + " --output-dir a --no-fcd");
  (void)run(arguments + " --output-dir b --no-fcd");
  (void)run("coordinate -c '" + kQuiet + "' --end 200 --seed 8 --no-view --output-dir c");
  const std::string vehicles = content_of(directory_.path("a/vehicles.csv"));
  EXPECT_GT(vehicles.size(), 1000U);
  EXPECT_EQ(vehicles, content_of(directory_.path("b/vehicles.csv")));
  EXPECT_NE(vehicles, content_of(directory_.path("c/vehicles.csv")));
  EXPECT_FALSE(fs::exists(directory_.path("a/fcd.xml")));
  EXPECT_FALSE(fs::exists(directory_.path("a/view.html")));
}

TEST_F(Coordinate, WithoutItsPlannerNobodyIsHit) {
  const Outcome outcome = run("coordinate -c '" + kBusy +
                              "' --end 300 --replan-budget-ms 0 --replan-budget-from 100 --no-fcd");
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;  // those that have not arrived
  EXPECT_THAT(outcome.err, ContainsRegex("vehicles had not arrived at t = 300.00 s"));
  const json s = summary();
  EXPECT_EQ(s["status"], "end reached");
  EXPECT_EQ(s["audit"]["overlap_pairs_coordinated"], 0);
  EXPECT_GT(s["replans"], 50);
  const std::string replans = content_of(directory_.path("out/replans.csv"));
  const std::string last = replans.substr(replans.rfind('\n', replans.size() - 2) + 1);
  EXPECT_LT(std::stod(last), 100.0);
  EXPECT_GT(s["completed"], 60);  // traffic goes on by right of way
}

TEST_F(Coordinate, AnInterruptedRunLeavesCompleteFiles) {
  const Outcome outcome = during_a_run("kill -INT $pid");
  EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
  EXPECT_EQ(summary()["status"], "interrupted");
  EXPECT_GT(elements_in("out/fcd.xml", "timestep"), 10);
  EXPECT_GT(elements_in("out/tripinfo.xml", "tripinfo"), 0);
  expect_no_files_but(7);
}

//   A terminal, and `timeout`, signal the whole process group: the one that simulates hears it
//   twice.
TEST_F(Coordinate, ASignalToTheWholeGroupIsOneWishToEnd) {
  const Outcome outcome = during_a_run("kill -TERM $sumo $pid");
  EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
  EXPECT_EQ(summary()["status"], "interrupted");
  expect_no_files_but(7);
}

TEST_F(Coordinate, ACrashOfSumoIsOneLine) {
  const Outcome outcome = during_a_run("kill -ABRT $sumo");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err,
              MatchesRegex("mvtp: control zone 1 of 1: junction C; 12 movements\n"
                           "mvtp: coordinate: the simulation crashed .Aborted.; [^\n]*\n"));
  EXPECT_FALSE(fs::exists(directory_.path("out/summary.json")));
}

}  // namespace
}  // namespace mvtp
