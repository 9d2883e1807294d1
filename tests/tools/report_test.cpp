#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/tools/program_fixture.hpp"
#include "tools/report/summary.hpp"

namespace mvtp {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

ResultRow failed(const std::string& instance, const std::string& algorithm, double runtime) {
  ResultRow row;
  row.instance = instance;
  row.algorithm = algorithm;
  row.status = "timeout";
  row.runtime = runtime;
  row.version = "0.1.0";
  return row;
}

ResultRow solved(const std::string& instance, const std::string& algorithm, double makespan,
                 double runtime = 1.0) {
  ResultRow row = failed(instance, algorithm, runtime);
  row.status = "solved";
  row.valid = true;
  row.makespan = makespan;
  row.makespan_steps = std::uint64_t(makespan);
  row.lower_bound = 10.0;
  row.first_solution = runtime / 2;
  return row;
}

// ---- names

TEST(InstanceTraits, AreReadFromTheNamesOfOurSuites) {
  EXPECT_EQ(traits_of("dense_map50x50_obst20_a025_ex07.yaml"),
            (InstanceTraits{"dense", "50 x 50 m, 20 obstacles", 25}));
  EXPECT_EQ(traits_of("all/crowd_map300x300_obst0_a1000_ex00.yaml"),
            (InstanceTraits{"crowd", "300 x 300 m, empty", 1000}));
  EXPECT_EQ(traits_of("typical_map50x50_circle_a002_ex00.yaml"),
            (InstanceTraits{"typical", "50 x 50 m, circle", 2}));
}

TEST(InstanceTraits, AreReadFromTheNamesOfCsdo) {
  EXPECT_EQ(traits_of("map50by50/agents5/obstacle/map_50by50_obst25_agents5_ex0.yaml"),
            (InstanceTraits{"results", "50 x 50 m, 25 obstacles", 5}));
  EXPECT_EQ(traits_of("map100by100/agents100/empty/map_100by100_obst0_agents100_ex9.yaml"),
            (InstanceTraits{"results", "100 x 100 m, empty", 100}));
  EXPECT_EQ(traits_of("room/agents20/map_100by100_agents20_ex3.yaml"),
            (InstanceTraits{"results", "100 x 100 m, room", 20}));
}

TEST(InstanceTraits, OfOtherNamesAreWhatTheySay) {
  EXPECT_EQ(traits_of("scenarios/circle8.yaml"), (InstanceTraits{"results", "circle", 8}));
  EXPECT_EQ(traits_of("some/where/x.yaml"), (InstanceTraits{"results", "some/where", {}}));
  EXPECT_EQ(traits_of("x.yaml"), (InstanceTraits{"results", "other", {}}));
  EXPECT_EQ(traits_of("_a99999999999999999999_.yaml"), (InstanceTraits{"results", "other", {}}));
}

// ---- figures

const std::string kOne = "sparse_map50x50_obst20_a004_ex00.yaml";
const std::string kTwo = "sparse_map50x50_obst20_a004_ex01.yaml";
const std::string kThree = "sparse_map50x50_obst20_a004_ex02.yaml";

CellSummary only_cell(const std::vector<ResultRow>& rows, std::optional<double> limit) {
  const std::vector<SuiteSummary> suites = summarise(rows, limit);
  EXPECT_THAT(suites, SizeIs(1));
  EXPECT_THAT(suites[0].maps, SizeIs(1));
  EXPECT_THAT(suites[0].maps[0].cells, SizeIs(1));
  return suites[0].maps[0].cells[0];
}

TEST(Summary, MakespansCountSuccessesAndRunTimesAllRuns) {
  const std::vector<ResultRow> rows = {solved(kOne, "escot", 12.0, 1.0),
                                       solved(kTwo, "escot", 16.0, 3.0),
                                       failed(kThree, "escot", 5.0)};
  const CellSummary cell = only_cell(rows, std::nullopt);
  EXPECT_EQ(cell.runs, 3);
  EXPECT_EQ(cell.valid, 2);
  EXPECT_DOUBLE_EQ(cell.makespan_steps->mean, 14.0);
  EXPECT_DOUBLE_EQ(cell.makespan_steps->deviation.value(), std::sqrt(8.0));
  EXPECT_DOUBLE_EQ(cell.ratio->mean, 1.4);
  EXPECT_DOUBLE_EQ(cell.first_solution->mean, 1.0);
  EXPECT_DOUBLE_EQ(cell.runtime.mean, 3.0);
  EXPECT_DOUBLE_EQ(only_cell(rows, 60.0).runtime.mean, 64.0 / 3.0);
}

//   What the solver calls solved is none if the referee objects.
TEST(Summary, InvalidPlansAreNoSuccesses) {
  ResultRow invalid = solved(kOne, "escot", 12.0);
  invalid.valid = false;
  const CellSummary cell = only_cell({invalid}, 60.0);
  EXPECT_EQ(cell.solved, 1);
  EXPECT_EQ(cell.valid, 0);
  EXPECT_FALSE(cell.makespan_steps);
  EXPECT_FALSE(cell.ratio);
  EXPECT_EQ(cell.runtime.mean, 60.0);
}

TEST(Summary, SuitesMapsRobotsAndAlgorithmsStandInOrder) {
  std::vector<ResultRow> rows;
  for (const char* name :
       {"dense/room/map100x100_a020.yaml", "dense_map100x100_obst0_a020_ex00.yaml",
        "dense_map100x100_obst50_a020_ex00.yaml", "dense_map50x50_obst20_a010_ex00.yaml",
        "dense_map50x50_obst0_a100_ex00.yaml", "dense_map50x50_obst0_a020_ex00.yaml"}) {
    for (const char* algorithm : {"pbcr", "another", "escot-star", "escot"}) {
      rows.push_back(solved(name, algorithm, 20.0));
    }
  }
  rows.push_back(solved(kOne, "sha", 20.0));
  const std::vector<SuiteSummary> suites = summarise(rows, std::nullopt);
  ASSERT_THAT(suites, ElementsAre(Field(&SuiteSummary::suite, "dense"),
                                  Field(&SuiteSummary::suite, "sparse")));
  EXPECT_THAT(suites[0].algorithms, ElementsAre("escot-star", "escot", "pbcr", "another"));
  EXPECT_THAT(suites[0].maps, ElementsAre(Field(&MapSummary::map, "50 x 50 m, empty"),
                                          Field(&MapSummary::map, "50 x 50 m, 20 obstacles"),
                                          Field(&MapSummary::map, "100 x 100 m, empty"),
                                          Field(&MapSummary::map, "100 x 100 m, 50 obstacles"),
                                          Field(&MapSummary::map, "100 x 100 m, room")));
  const std::vector<CellSummary>& cells = suites[0].maps[0].cells;
  ASSERT_THAT(cells, SizeIs(8));
  EXPECT_EQ(cells[0].robots, 20);
  EXPECT_EQ(cells[0].algorithm, "escot-star");
  EXPECT_EQ(cells[4].robots, 100);
}

TEST(Summary, AlgorithmsAreComparedWhereBothSucceeded) {
  const std::vector<SuiteSummary> suites =
      summarise(std::vector{solved(kOne, "escot", 12.0), solved(kOne, "pbcr", 24.0),
                            solved(kTwo, "escot", 10.0), solved(kTwo, "pbcr", 80.0),
                            solved(kThree, "escot", 99.0), failed(kThree, "pbcr", 60.0)},
                std::nullopt);
  ASSERT_THAT(suites[0].comparisons, SizeIs(2));
  EXPECT_EQ(suites[0].comparisons[1].algorithm, "pbcr");
  EXPECT_EQ(suites[0].comparisons[1].runs, 2);
  EXPECT_NEAR(suites[0].comparisons[1].ratio, 4.0, 1e-12);  // of 2 and 8
  EXPECT_NEAR(suites[0].comparisons[0].ratio, 0.25, 1e-12);
}

TEST(Report, TablesSayWhatWasMeasured) {
  ResultRow invalid = solved(kTwo, "pbcr", 12.0, 2.0);
  invalid.valid = false;
  const std::string text =
      to_markdown(summarise(std::vector{solved(kOne, "escot", 12.0, 0.25), invalid}, 60.0), 60.0);
  EXPECT_THAT(text, HasSubstr("\n## sparse\n\n### 50 x 50 m, 20 obstacles\n"));
  EXPECT_THAT(text, HasSubstr("\n| 4 | escot | 1 | 100 % | 12.0 ± 0.0 | 1.200 ± 0.000 | 0.125 | "
                              "0.250 | 0 |\n"));
  EXPECT_THAT(text,
              HasSubstr("\n| 4 | pbcr | 1 | 0 % (solver: 1 of 1) | – | – | – | 60.0 | 0 |\n"));
  EXPECT_THAT(text, HasSubstr("counts as the time limit of 60 s"));
}

TEST(Report, NumbersForTheFiguresHaveGapsWhereThereIsNoValue) {
  const auto json = nlohmann::json::parse(to_json(
      summarise(std::vector{failed(kOne, "escot", 60.0), failed("x.yaml", "escot", 1.0)}, {}), {}));
  EXPECT_TRUE(json["time_limit"].is_null());
  ASSERT_THAT(json["figures"], SizeIs(1));  // x.yaml does not say how many robots it has
  const auto& line = json["figures"][0]["panels"][0]["lines"][0];
  EXPECT_EQ(line["success"][0], 0.0);
  EXPECT_TRUE(line["makespan"][0].is_null());
  EXPECT_EQ(line["runtime"][0], 60.0);
}

// ---- the command

class ReportCommand : public Program {
 protected:
  ReportCommand() {
    std::string text = results_header();
    for (const char* algorithm : {"escot", "pbcr", "mine"}) {
      text += to_csv(solved(kOne, algorithm, 12.0)) + to_csv(failed(kTwo, algorithm, 60.0));
      text += to_csv(solved("circle8.yaml", algorithm, 30.0));
    }
    (void)directory_.file("r.csv", text);
  }
};

TEST_F(ReportCommand, WritesTheSameBytesAgain) {
  const Outcome outcome = run("report r.csv -o a --time-limit 60");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out + outcome.err, "");
  EXPECT_EQ(shell("ls a").out,
            "figures.json\nresults.png\nresults.svg\nsparse.png\nsparse.svg\ntables.md\n");
  ASSERT_EQ(run("report r.csv -o b --time-limit 60").exit_code, 0);
  EXPECT_EQ(shell("diff -r a b").exit_code, 0);
  EXPECT_THAT(content_of(directory_.path("a/sparse.svg")), HasSubstr("</svg>"));
}

TEST_F(ReportCommand, SaysWhatToInstallForTheFigures) {
  EXPECT_EQ(shell("printf '#!/bin/sh\\nexit 3\\n' >py && chmod +x py").exit_code, 0);
  const std::string python = directory_.path("py");
  expect_refused("report r.csv -o a --python " + python,
                 ".*/py: has no matplotlib, .*; install python3-matplotlib");
  EXPECT_THAT(content_of(directory_.path("a/tables.md")), HasSubstr("## sparse"));
  expect_refused("report r.csv -o a --python none", "none: is missing: .*python3-matplotlib.*");
  EXPECT_EQ(shell("printf '#!/bin/sh\\nexit 1\\n' >py").exit_code, 0);
  expect_refused("report r.csv -o a --python " + python, "a: the figures could not be drawn .*");
}

//   There is room for the tables, but for no figure.
TEST_F(ReportCommand, AFullDiskIsToldInOneLine) {
  // Nor for matplotlib's cache of fonts, which it makes anew.
  const Outcome outcome = shell(std::string("trap '' XFSZ; ulimit -f 16; MPLCONFIGDIR=$PWD '") +
                                MVTP_PROGRAM + "' report r.csv -o a");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.err,
            "mvtp: a: the figures cannot be written there: is the disk full? Make room, or choose "
            "another --output-dir\n");
  EXPECT_EQ(shell("ls a").out, "figures.json\ntables.md\n");
}

TEST_F(ReportCommand, RefusesWhatItCannotRead) {
  (void)directory_.file("none.csv", results_header());
  (void)directory_.file("bad.csv", "a,b\n");
  expect_refused("report", "report: RESULTS is required; .*");
  expect_refused("report r.csv", "report: --output-dir is required; .*");
  expect_refused("report no.csv -o a", "no.csv: cannot be read: .*");
  expect_refused("report none.csv -o a", "none.csv: has no rows; .*");
  expect_refused("report bad.csv -o a", "bad.csv:1: has not the columns .*");
  expect_refused("report r.csv -o r.csv", "r.csv: cannot make this folder .*");
  expect_refused("report r.csv -o a --time-limit -1", "report: --time-limit: is \"-1\"; .*");
}

}  // namespace
}  // namespace mvtp
