#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/tools/program_fixture.hpp"

namespace mvtp {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class ReportOfRuns : public Program {
 protected:
  static constexpr const char* kScenario = MVTP_SCENARIOS "/crossroads/crossroads-400.sumocfg";

  ReportOfRuns() {
    const Outcome outcome = run(std::string("compare -c '") + kScenario +
                                "' --controllers static,escot --seeds 1-2 --end 40 --quiet "
                                "--output-dir runs");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  [[nodiscard]] json figures(const std::string& folder) const {
    return json::parse(content_of(directory_.path(folder + "/figures.json")))["figures"];
  }
};

TEST_F(ReportOfRuns, DrawsTheSignalBesideTheCoordinatedRun) {
  const Outcome outcome = run("report runs -o a --movement 'Ei>Wo' --begin 10 --end 35");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out + outcome.err, IsEmpty());
  EXPECT_EQ(shell("ls a").out,
            "arrivals-by-minute.png\narrivals-by-minute.svg\nencounters.png\nencounters.svg\n"
            "figures.json\ntables.md\ntime-space.png\ntime-space.svg\n");
  EXPECT_THAT(content_of(directory_.path("a/time-space.svg")), HasSubstr("</svg>"));

  const json diagram = figures("a")[1];
  EXPECT_EQ(diagram["movement"], "Ei>Wo");
  EXPECT_EQ(diagram["time"], json({10.0, 35.0}));
  ASSERT_EQ(diagram["panels"].size(), 2U);  // those runs that have a replay
  EXPECT_EQ(diagram["panels"][0]["title"], "escot, seed 1");
  EXPECT_EQ(diagram["panels"][1]["title"], "static, seed 1");
  EXPECT_THAT(diagram["panels"][0]["lines"].dump(), HasSubstr("\"controlled\""));
  EXPECT_THAT(diagram["panels"][1]["lines"].dump(), Not(HasSubstr("\"controlled\"")));
  EXPECT_EQ(diagram["panels"][1]["signals"].size(), 1U);
  ASSERT_EQ(diagram["stop_lines"].size(), 1U);
  const double line = diagram["stop_lines"][0];
  const json zones = diagram["panels"][0]["zones"];
  ASSERT_EQ(zones.size(), 1U);
  EXPECT_LT(zones[0][0], line);
  EXPECT_GT(zones[0][1], line);
  EXPECT_TRUE(diagram["panels"][1]["zones"].empty()) << "nobody is under control at the signal";

  const json arrivals = figures("a")[0]["panels"][0]["lines"];
  ASSERT_EQ(arrivals.size(), 2U);  // means over the seeds
  EXPECT_EQ(arrivals[0]["label"], "escot");
  EXPECT_THAT(content_of(directory_.path("a/tables.md")), HasSubstr("| static | 2/2 |"));

  const json encounters = figures("a")[2]["panels"][0]["lines"];
  ASSERT_EQ(encounters.size(), 2U);
  EXPECT_EQ(encounters[0]["x"].size(), 10U);
  double pairs = 0.0;
  for (const double mean : encounters[0]["y"]) pairs += mean;
  double summed = 0.0;
  for (const char* seed : {"1", "2"}) {
    const std::string file = std::string("runs/escot-") + seed + "/summary.json";
    summed += json::parse(content_of(directory_.path(file)))["pet_s"]["pairs"].get<double>();
  }
  EXPECT_NEAR(pairs, summed / 2.0, 1e-9);

  EXPECT_EQ(run("report runs -o b --movement 'Ei>Wo' --begin 10 --end 35").exit_code, 0);
  EXPECT_EQ(shell("diff -r a b").exit_code, 0);
}

TEST_F(ReportOfRuns, TakesRunsOneByOne) {
  EXPECT_EQ(run("report runs/escot-1 -o a").exit_code, 0);
  EXPECT_EQ(figures("a")[1]["panels"].size(), 1U);
  EXPECT_EQ(figures("a")[1]["panels"][0]["title"], "escot");
  EXPECT_EQ(run("report runs/static-1 runs/escot-1 -o b").exit_code, 0);
  EXPECT_EQ(figures("b")[1]["panels"][0]["title"], "static");
  //   The same control and seed twice: their folders tell them apart.
  EXPECT_EQ(shell("cp -r runs/escot-1 other").exit_code, 0);
  EXPECT_EQ(run("report runs/escot-1 other -o c").exit_code, 0);
  EXPECT_EQ(figures("c")[1]["panels"][1]["title"], "other");
}

TEST_F(ReportOfRuns, WhatCannotBeDrawnIsToldInOneLine) {
  EXPECT_EQ(shell("mkdir empty; echo x >r.csv").exit_code, 0);
  expect_refused("report empty -o a", "empty: holds no summary.json; give [^\n]*");
  expect_refused("report runs r.csv -o a", "r.csv: is neither a table [^\n]*");
  expect_refused("report r.csv runs -o a", "runs: is one too many: [^\n]*");
  expect_refused("report runs/escot-2 -o a",
                 "runs/escot-2/view.html: is missing, [^\n]*; run without --no-view");
  expect_refused("report runs -o a --movement nowhere",
                 "runs/escot-1/view.html: has no vehicle of the movement \"nowhere\"; [^\n]*");
  expect_refused("report runs -o a --begin -1", "report: --begin: is \"-1\"; [^\n]*");
  EXPECT_FALSE(std::filesystem::exists(directory_.path("a")));
}

}  // namespace
}  // namespace mvtp
