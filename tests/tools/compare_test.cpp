#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "planner/problem/input_error.hpp"
#include "tests/tools/program_fixture.hpp"
#include "tools/runs/comparison.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

using nlohmann::json;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::Not;

const std::string kScenario = std::string(MVTP_SCENARIOS) + "/crossroads/crossroads.sumocfg";

class Compare : public Program {
 protected:
  [[nodiscard]] static std::string command(const std::string& more) {
    return "compare -c '" + kScenario + "' --end 60 --output-dir out " + more;
  }
};

TEST(MeanAndDeviation, IsThatOfTheSample) {
  const std::vector<double> values = {2, 4, 4, 4, 5, 5, 7, 9};
  const MeanAndDeviation m = mean_and_deviation(values);
  EXPECT_DOUBLE_EQ(m.mean, 5.0);
  EXPECT_NEAR(m.deviation.value(), 2.13809, 1e-5);  // sqrt(32 / 7)
  EXPECT_FALSE(mean_and_deviation(std::vector<double>{3.0}).deviation.has_value());
}

TEST(Comparison, ShowsARunThatFailed) {
  ComparedRun good{.control = "coordinated", .seed = 1, .failure = "", .status = "finished"};
  for (const ComparedFigure& figure : compared_figures()) good.figures[figure.name] = 0.0;
  good.figures["delay_mean_s"] = 2.5;
  const ComparedRun bad{.control = "coordinated", .seed = 2, .failure = "crashed (Aborted), \"x\""};
  const std::vector<ComparedRun> runs = {good, bad};

  EXPECT_THAT(comparison_table(runs), ContainsRegex("coordinated +1/2 +2.50 "));
  EXPECT_THAT(comparison_table(runs),
              HasSubstr("\nFAILED: coordinated, seed 2: crashed (Aborted), \"x\"\n"));
  EXPECT_THAT(comparison_csv(runs),
              HasSubstr("\ncoordinated,2,,\"crashed (Aborted), \"\"x\"\"\","));
  const json j = json::parse(comparison_json(runs, "x.sumocfg", "1", "mvtp"));
  EXPECT_EQ(j["controls"][0]["failed"], 1);
  EXPECT_EQ(j["controls"][0]["delay_mean_s"]["mean"], 2.5);
  EXPECT_TRUE(j["controls"][0]["delay_mean_s"]["sd"].is_null());
  EXPECT_TRUE(succeeded(good));
  good.status = "end reached";
  good.figures["simulated_s"] = 120.0;  // wherever the scenario begins
  EXPECT_THAT(comparison_table({&good, 1}),
              HasSubstr("coordinated, seed 1: end reached after 120 s\n"));
  EXPECT_FALSE(succeeded(bad));
}

TEST(Comparison, AnOverlapUnderControlIsNoSuccess) {
  ComparedRun run{.control = "aim", .drives = true, .failure = "", .status = "finished"};
  run.figures["people_touched_coordinated"] = 0.0;
  run.figures["overlap_pairs_coordinated"] = 1.0;
  EXPECT_FALSE(succeeded(run));
  run.figures["overlap_pairs_coordinated"] = 0.0;
  EXPECT_TRUE(succeeded(run));
  run.figures["people_touched_coordinated"] = 1.0;
  EXPECT_FALSE(succeeded(run));
  run.figures["people_touched_coordinated"] = 0.0;
  run.status = "stuck";
  EXPECT_FALSE(succeeded(run));
  run.drives = false;  // a light that cannot cope is a result
  EXPECT_TRUE(succeeded(run));
}

TEST(Comparison, RefusesWhatIsNoSummary) {
  ComparedRun run;
  EXPECT_THROW(read_summary("{", "s.json", run), InputError);
  EXPECT_THROW(read_summary("[]", "s.json", run), InputError);
  EXPECT_THROW(read_summary(R"({"status": "finished"})", "s.json", run), InputError);
}

TEST_F(Compare, RunsEveryControlWithTheSameVehicles) {
  const Outcome outcome = run(command("--seeds 1,3 --quiet"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, IsEmpty());
  for (const char* control : {"static", "actuated", "priority", "coordinated"}) {
    EXPECT_THAT(outcome.out, ContainsRegex(std::string("\n") + control + " +2/2 +[0-9.]+ ± "));
    for (const char* seed : {"1", "3"}) {
      const std::string folder = std::string("out/") + control + "-" + seed;
      EXPECT_TRUE(fs::exists(directory_.path(folder + "/summary.json"))) << folder;
      EXPECT_FALSE(fs::exists(directory_.path(folder + "/fcd.xml"))) << folder;
    }
  }
  EXPECT_THAT(outcome.out, HasSubstr("replay: out/view.html\n"));
  EXPECT_TRUE(fs::exists(directory_.path("out/view.html")));
  const std::string csv = content_of(directory_.path("out/compare.csv"));
  EXPECT_EQ(std::ranges::count(csv, '\n'), 9);
  const json j = json::parse(content_of(directory_.path("out/compare.json")));
  ASSERT_EQ(j["controls"].size(), 4U);
  for (const json& control : j["controls"]) {
    EXPECT_EQ(control["vehicles"], j["controls"][0]["vehicles"]);
    EXPECT_EQ(control["runs"], 2);
  }
}

TEST_F(Compare, RefusesBadInputBeforeAnyRun) {
  for (const char* seeds : {"", "x", "1-", "5-1", "1,,2", "-1", "1-100000", "99999999999"}) {
    expect_refused(command(std::string("--seeds='") + seeds + "'"), "[^\n]*--seeds[^\n]*");
  }
  expect_refused("compare -c missing.sumocfg", "missing.sumocfg: no such file; [^\n]*");
  expect_refused(command("--jobs 0"), "compare: --jobs: [^\n]*");
  EXPECT_EQ(directory_.size(), 0);
}

TEST_F(Compare, ControllersAreComparedByName) {
  const Outcome outcome =
      run(command("--controllers max-wave,static,prioritized,static --seeds 1 --quiet"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const json j = json::parse(content_of(directory_.path("out/compare.json")));
  ASSERT_EQ(j["controls"].size(), 3U);
  EXPECT_EQ(j["controls"][0]["control"], "max-wave");
  EXPECT_EQ(j["controls"][1]["control"], "static");
  EXPECT_EQ(j["controls"][2]["control"], "prioritized");
  for (const json& c : j["controls"]) {
    EXPECT_EQ(c["vehicles"], j["controls"][0]["vehicles"]);
  }
  EXPECT_EQ(j["controls"][0]["replans"]["mean"], 0.0);
  EXPECT_GT(j["controls"][2]["replans"]["mean"], 0.0);
  // The phases of the twin with a light, although the crossroads themselves have none.
  const json run = json::parse(content_of(directory_.path("out/static-1/summary.json")));
  EXPECT_THAT(run["command"].get<std::string>(), HasSubstr("crossroads.static.sumocfg"));
  EXPECT_EQ(run["controller"], "static");
}

TEST_F(Compare, RivalsForMixedTrafficRunUnderTheSignalsOfTheNetwork) {
  const std::string scenario = MVTP_SCENARIOS "/crossroads/crossroads.actuated.sumocfg";
  const Outcome outcome = run("compare -c '" + scenario +
                              "' --end 60 --output-dir out --controllers sumo,aim,fcfs-light,h-aim "
                              "--penetration 0.5 --seeds 1 --quiet");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const json j = json::parse(content_of(directory_.path("out/compare.json")));
  ASSERT_EQ(j["controls"].size(), 4U);
  for (const json& c : j["controls"]) EXPECT_EQ(c["overlap_pairs"]["mean"], 0.0) << c["control"];
  for (const char* rival : {"fcfs-light", "h-aim"}) {
    const json summary =
        json::parse(content_of(directory_.path("out/" + std::string(rival) + "-1/summary.json")));
    EXPECT_EQ(summary["controller"], rival);
    EXPECT_EQ(summary["penetration"], 0.5);
  }
}

TEST_F(Compare, RefusesControllersThatCannotBe) {
  expect_refused(command("--controllers escot,magic"),
                 "--controllers magic: is no controller; there are escot, [^\n]*max-wave[^\n]*");
  (void)directory_.file("y.sumocfg", std::string("<configuration><net-file value=\"") +
                                         MVTP_NETWORKS + "/crossroads.net.xml\"/></configuration>");
  expect_refused("compare -c y.sumocfg --output-dir out --controllers max-wave",
                 "--controllers max-wave: needs traffic signals: y.sumocfg has none, [^\n]*");
  expect_refused("coordinate -c y.sumocfg --output-dir out --controller max-wave",
                 "--controller max-wave: runs traffic signals, and there is none [^\n]*");
}

TEST_F(Compare, TellsWhatARunHasAgainstTheInput) {
  expect_refused(command("--quiet --junction nowhere"),
                 "--junction nowhere: the network has no junction with this id; there is C");
}

TEST_F(Compare, AnInterruptEndsTheRunsToo) {
  const std::string script = std::string("'") + MVTP_PROGRAM + "' compare -c '" + kScenario +
                             "' --end 600 --seeds 1-20 --output-dir out & pid=$!\n"
                             "until [ -f out/static-1/tripinfo.xml.part ]; do\n"
                             "  [ -d /proc/$pid ] || exit 99; sleep 0.05; done\n"
                             "kill -INT $pid; wait $pid; exit $?";
  const Outcome outcome = shell(script);
  EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("seed 20: did not run"));
  for (const auto& entry : fs::recursive_directory_iterator(directory_.path("out"))) {
    EXPECT_NE(entry.path().extension(), ".part") << entry.path();
  }
}

TEST_F(Compare, AFailedRunIsARowAndTheOthersGoOn) {
  const std::string car = "<vehicle id=\"%\" depart=\"@\"><route edges=\"#\"/></vehicle>";
  const auto vehicle = [&](char id, const char* depart, const char* edges) {
    std::string text = car;
    text.replace(text.find('%'), 1, 1, id).replace(text.find('@'), 1, depart);
    return text.replace(text.find('#'), 1, edges);
  };
  (void)directory_.file("x.rou.xml", "<routes>" + vehicle('a', "0", "Wi Eo") +
                                         vehicle('b', "500", "Wi Eo") +
                                         vehicle('c', "900", "Wi Atlantis") + "</routes>");
  (void)directory_.file("x.sumocfg", std::string("<configuration><net-file value=\"") +
                                         MVTP_NETWORKS +
                                         "/crossroads.net.xml\"/><route-files value=\"x.rou.xml\"/>"
                                         "</configuration>");
  const Outcome outcome = run("compare -c x.sumocfg --seeds 1 --quiet --output-dir out");
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("mvtp: note: SUMO runs at steps of 0.1 s, not"));
  EXPECT_THAT(outcome.out, ContainsRegex("\nFAILED: priority, seed 1: x.sumocfg: SUMO stopped "));
  EXPECT_THAT(outcome.out,
              ContainsRegex("\nFAILED: coordinated, seed 1: x.sumocfg: SUMO stopped "));
  const std::string csv = content_of(directory_.path("out/compare.csv"));
  EXPECT_THAT(csv, HasSubstr("\npriority,1,failed,"));
}

//   What a run said was lost, too.
TEST_F(Compare, AFullDiskIsToldInOneLine) {
  const Outcome outcome =
      shell(std::string("(trap '' XFSZ; ulimit -f 0; '") + MVTP_PROGRAM + "' compare -c '" +
            kScenario + "' --seeds 1 --quiet --junction nowhere --output-dir out) 2>&1 | cat");
  EXPECT_THAT(outcome.out, MatchesRegex("mvtp: out/[^\n]*: the disk is full; make room or choose "
                                        "another --output-dir\n"));
}

TEST_F(Compare, ACrashedRunIsToldAndNotHidden) {
  const std::string script = std::string("'") + MVTP_PROGRAM + "' compare -c '" + kScenario +
                             "' --end 600 --seeds 1 --jobs 1 --output-dir out & pid=$!\n"
                             "until [ -f out/static-1/tripinfo.xml.part ]; do\n"
                             "  [ -d /proc/$pid ] || exit 99; sleep 0.05; done\n"
                             "read -r compare < /proc/$pid/task/$pid/children\n"
                             "read -r run < /proc/$compare/task/$compare/children\n"
                             "kill -ABRT $run; wait $pid; exit $?";
  const Outcome outcome = shell(script);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.out, ContainsRegex("\nstatic +0/1 "));
  EXPECT_THAT(outcome.out, ContainsRegex("\nFAILED: static, seed 1: crashed .Aborted."));
  EXPECT_THAT(outcome.out, ContainsRegex("\ncoordinated +1/1 +[0-9.]+ "));
}

}  // namespace
}  // namespace mvtp
