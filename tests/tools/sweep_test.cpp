#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "planner/problem/input_error.hpp"
#include "tests/tools/program_fixture.hpp"
#include "tools/cli/number_list.hpp"
#include "tools/report/sweep_figures.hpp"
#include "tools/runs/merge_rows.hpp"
#include "tools/sweep/rows.hpp"

namespace mvtp {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kScenario = std::string(MVTP_SCENARIOS) + "/crossroads/crossroads.sumocfg";

SweepRow example() {
  return {.scenario = "a,b.sumocfg",
          .controller = "aim",
          .scale = 0.75,
          .penetration = 0.2,
          .seed = 7,
          .status = "end reached",
          .figures = {{"delay_mean_s", 1.0 / 3.0}, {"vehicles", 12.0}},
          .arrivals = {0, 3, 9},
          .runtime = 1.5,
          .peak_rss = 40.0,
          .version = "1.0"};
}

TEST(NumberList, ReadsListsAndRanges) {
  const auto read = [](const char* text) { return parse_numbers("--scale", text, 0.0, 10.0); };
  EXPECT_EQ(read("0.5"), (std::vector<double>{0.5}));
  EXPECT_EQ(read("2,1,2"), (std::vector<double>{1, 2}));
  EXPECT_EQ(read("0.5:2.0:0.25"), (std::vector<double>{0.5, 0.75, 1, 1.25, 1.5, 1.75, 2}));
  EXPECT_EQ(read("0:1:0.1").size(), 11U);
  EXPECT_EQ(read("0:1:0.1")[3], 0.3);  // not 0.30000000000000004
  EXPECT_EQ(read("1:2:0.75,5"), (std::vector<double>{1, 1.75, 5}));
  for (const char* text : {"", "x", "1,", "1:2", "2:1:0.1", "1:2:0", "1:2:-1", "nan", "inf", "11",
                           "-1", "0:10:0.0001", "1:2:3:4"}) {
    EXPECT_THROW((void)read(text), InputError) << text;
  }
}

TEST(SweepRows, ComeBackAsTheyWere) {
  TemporaryDirectory directory;
  const std::string file = directory.file("s.csv", sweep_header() + to_csv(example()));
  EXPECT_EQ(read_sweep(file), std::vector<SweepRow>{example()});
}

TEST(SweepRows, WhatIsNoneIsRefused) {
  TemporaryDirectory directory;
  std::string line = to_csv(example());
  const auto refused = [&](const std::string& text, const std::string& why) {
    const std::string file = directory.file("s.csv", text);
    try {
      (void)read_sweep(file);
      ADD_FAILURE() << why;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(why));
    }
  };
  refused("scenar", "is no table of mvtp sweep");
  refused("x,y\n1,2\n", "has not the columns");
  refused(sweep_header() + line.substr(0, line.size() - 1), "incomplete last line");
  refused(sweep_header() + "a,b\n", "has 2 fields in place of");
  line.replace(line.find(",7,"), 3, ",x,");
  refused(sweep_header() + line, "s.csv:2: seed: is \"x\"; give a whole number");
}

TEST(SweepRows, AreMergedOnceEach) {
  SweepRow first = example();
  SweepRow again = example();
  again.runtime = 9.0;
  SweepRow other = example();
  other.scale = 0.5;
  const auto key = [](const SweepRow& row) { return key_of(row); };
  EXPECT_EQ(merge_rows<SweepRow>({{first}, {again, other}}, key),
            (std::vector<SweepRow>{other, first}));
}

TEST(SweepFigures, ShowMeansOverTheSeeds) {
  std::vector<SweepRow> rows;
  for (const double scale : {0.5, 1.0}) {
    for (const double delay : {1.0, 3.0}) {
      SweepRow row = example();
      row.scale = scale;
      row.seed = rows.size();
      row.figures["delay_mean_s"] = scale * delay;
      rows.push_back(row);
      row.controller = "static";  // the same at every penetration
      row.penetration = 0.0;
      row.figures["delay_mean_s"] = 10.0 * scale;
      rows.push_back(row);
    }
  }
  // With one penetration for each controller there is nothing to draw over it.
  EXPECT_EQ(json::parse(sweep_to_json(rows))["figures"].size(), 2U);
  rows.push_back(example());
  rows.back().scale = rows.back().penetration = 1.0;
  const json figures = json::parse(sweep_to_json(rows))["figures"];
  ASSERT_EQ(figures.size(), 3U);
  const json demand = figures[0]["panels"][0]["lines"];
  EXPECT_EQ(demand[0]["label"], "aim 20 %");
  EXPECT_EQ(demand[0]["x"], json({0.5, 1.0}));
  EXPECT_EQ(demand[0]["y"], json({1.0, 2.0}));
  EXPECT_NEAR(demand[0]["sd"][1], std::sqrt(2.0), 1e-12);
  const json shares = figures[1]["panels"][1]["lines"];
  EXPECT_EQ(shares[0]["x"], json({0.2, 1.0}));
  EXPECT_EQ(shares[1]["x"], json({0.0, 1.0}));
  EXPECT_EQ(shares[1]["y"], json({10.0, 10.0}));
  EXPECT_EQ(figures[2]["panels"][0]["lines"][0]["y"], json({0.0, 3.0, 9.0}));
  EXPECT_THAT(sweep_to_markdown(rows), HasSubstr("| 1 | 0.2 | aim | 2/2 | 2.00 ± 1.41 |"));
}

TEST(SweepFigures, ShowThoseUnderControlBesideTheHumanDrivenOnes) {
  std::vector<SweepRow> rows;
  for (const double share : {0.0, 0.5, 1.0}) {
    SweepRow row = example();
    row.penetration = share;
    row.figures["delay_mean_s"] = 3.0 - share;
    if (share > 0.0) row.figures["delay_controlled_s"] = 2.0 - share;
    if (share < 1.0) row.figures["delay_human_s"] = 4.0 - share;
    rows.push_back(row);
  }
  const json lines = json::parse(sweep_to_json(rows))["figures"][1]["panels"][0]["lines"];
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0]["label"], "aim");
  EXPECT_EQ(lines[1]["label"], "aim, under control");
  EXPECT_EQ(lines[1]["x"], json({0.5, 1.0}));
  EXPECT_EQ(lines[1]["y"], json({1.5, 1.0}));
  EXPECT_EQ(lines[2]["label"], "aim, human-driven");
  EXPECT_EQ(lines[2]["x"], json({0.0, 0.5}));
  EXPECT_EQ(lines[2]["y"], json({4.0, 3.5}));
}

class SweepCommand : public Program {
 protected:
  [[nodiscard]] static std::string sweep(const std::string& more) {
    return "sweep -c '" + kScenario + "' --end 30 --seeds 1 --quiet " + more;
  }
  /// Without what differs from run to run.
  [[nodiscard]] std::vector<SweepRow> rows(const std::string& file) const {
    std::vector<SweepRow> rows = read_sweep(directory_.path(file));
    for (SweepRow& row : rows) {
      row.runtime = row.peak_rss = 0.0;
      std::erase_if(row.figures, [](const auto& f) {
        return f.first.starts_with("replan_") || f.first == "real_time_factor";
      });
    }
    std::ranges::sort(rows, {}, [](const SweepRow& row) { return key_of(row); });
    return rows;
  }
};

TEST_F(SweepCommand, ShardsTogetherAreTheWholeAndAreDrawn) {
  const std::string what = sweep("--controllers static,prioritized --scale 1:2:1 ");
  Outcome outcome = run(what + "-o all.csv");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, IsEmpty());
  ASSERT_EQ(rows("all.csv").size(), 4U);
  EXPECT_EQ(run(what + "--shard 1/2 -o a.csv").exit_code, 0);
  EXPECT_EQ(run(what + "--shard 2/2 -o b.csv").exit_code, 0);
  EXPECT_EQ(rows("a.csv").size(), 2U);
  EXPECT_EQ(run("sweep merge a.csv b.csv a.csv -o merged.csv").exit_code, 0);
  EXPECT_EQ(rows("merged.csv"), rows("all.csv"));
  for (const SweepRow& row : rows("all.csv")) {
    EXPECT_EQ(row.status, "end reached");
    EXPECT_EQ(row.penetration, row.controller == "static" ? 0.0 : 1.0);
  }
  EXPECT_GT(rows("all.csv")[1].figures.at("vehicles"), rows("all.csv")[0].figures.at("vehicles"));

  outcome = run("report all.csv -o drawn");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* name : {"delay-over-demand.svg", "arrivals-by-minute.png", "tables.md"}) {
    EXPECT_TRUE(std::filesystem::exists(directory_.path(std::string("drawn/") + name))) << name;
  }
}

TEST_F(SweepCommand, GoesOnWhereItEnded) {
  ASSERT_EQ(run(sweep("-o s.csv")).exit_code, 0);
  const std::string before = content_of(directory_.path("s.csv"));
  expect_refused(sweep("-o s.csv"), "s.csv: exists; continue it with --resume, [^\n]*");
  EXPECT_EQ(run(sweep("--resume -o s.csv")).exit_code, 0);
  EXPECT_EQ(content_of(directory_.path("s.csv")), before);  // nothing was left to do
  EXPECT_EQ(run(sweep("--resume --penetration 0,1 -o s.csv")).exit_code, 0);
  EXPECT_EQ(rows("s.csv").size(), 2U);
  EXPECT_TRUE(content_of(directory_.path("s.csv")).starts_with(before));
}

TEST_F(SweepCommand, RunsWithDifferentOptionsNeverShareATable) {
  ASSERT_EQ(run(sweep("-o s.csv")).exit_code, 0);
  expect_refused(sweep("--resume --zone-radius 50 -o s.csv"),
                 "s.csv: has runs with --configuration=[^\n]*, not with "
                 "[^\n]*--zone-radius=50[^\n]*; give the same, [^\n]*");
  //   Another scenario may have the same name.
  namespace fs = std::filesystem;
  const fs::path there = fs::path(kScenario).parent_path();
  fs::create_directory_symlink(there.parent_path().parent_path() / "networks",
                               directory_.path("networks"));
  fs::create_directories(directory_.path("own/elsewhere"));
  fs::copy(there, directory_.path("own/elsewhere"));
  const std::string name = fs::path(kScenario).filename();
  expect_refused("sweep -c own/elsewhere/" + name + " --end 30 --seeds 1 -o s.csv --resume",
                 "s.csv: has runs with --configuration=[^\n]*, not with "
                 "--configuration=elsewhere/[^\n]*");
}

TEST_F(SweepCommand, AFullDiskIsNoResult) {
  const std::string words = std::string("'") + MVTP_PROGRAM + "' " + sweep("-o s.csv");
  const Outcome outcome = shell("trap '' XFSZ; ulimit -f 4; " + words);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, testing::MatchesRegex("mvtp: [^\n]*: the disk is full; make room or set "
                                                 "TMPDIR to another folder, and use --resume\n"));
  EXPECT_EQ(directory_.size(), 0) << "neither a table without rows nor a note on its options";
  EXPECT_EQ(run(sweep("--resume -o s.csv")).exit_code, 0);
  EXPECT_EQ(rows("s.csv").size(), 1U);
}

TEST_F(SweepCommand, WithoutRoomForTheHeadThereIsNoTable) {
  const std::string words = std::string("'") + MVTP_PROGRAM + "' " + sweep("-o s.csv");
  const Outcome outcome = shell("trap '' XFSZ; ulimit -f 1; " + words);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.err,
            "mvtp: s.csv: cannot be written: is the disk full? Make room and use --resume\n");
  EXPECT_EQ(directory_.size(), 0);
}

TEST_F(SweepCommand, BadInputIsOneLineAndNoFile) {
  expect_refused(sweep("-o s.csv --scale 0"), "--scale: is \"0\"; give numbers from [^\n]*");
  expect_refused(sweep("-o s.csv --penetration 2"), "--penetration: is \"2\"; [^\n]*");
  expect_refused(sweep("-o s.csv --shard 3/2"), "--shard: is \"3/2\"; [^\n]*");
  expect_refused(sweep("-o s.csv --controllers magic"), "--controllers magic: is no [^\n]*");
  expect_refused(sweep("-o s.csv -- --scale 2"), "SUMO option --scale: [^\n]*");
  expect_refused("sweep -o s.csv", "sweep: --configuration is required; [^\n]*");
  expect_refused("sweep -c '" + kScenario + "'", "sweep: --output is required; [^\n]*");
  expect_refused("sweep merge missing.csv -o s.csv", "missing.csv: cannot be read: [^\n]*");
  EXPECT_EQ(directory_.size(), 0);
}

TEST_F(SweepCommand, ARunThatIsRefusedIsARow) {
  const Outcome outcome = run(sweep("-o s.csv --junction nowhere"));
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("refused: --junction nowhere: the network has no junction"));
  ASSERT_EQ(rows("s.csv").size(), 1U);
  EXPECT_EQ(rows("s.csv")[0].status, "refused");
  EXPECT_THAT(rows("s.csv")[0].figures, IsEmpty());
}

TEST_F(Program, DoctorNamesWhatIsMissing) {
  const Outcome outcome = run("doctor");
  EXPECT_THAT(outcome.out, HasSubstr("ok       mvtp-sumo\n"));
  EXPECT_EQ(outcome.exit_code, 0);
  const Outcome bare = shell(std::string("PATH= '") + MVTP_PROGRAM + "' doctor");
  EXPECT_EQ(bare.exit_code, 0);
  EXPECT_THAT(bare.out, HasSubstr("absent   sumo-gui: without it not: coordinate --gui; install"));
  EXPECT_THAT(bare.out,
              HasSubstr("(networks/make.sh), roads of export --to openscenario; install"));
}

//   The program alone, without what belongs to it.
TEST_F(Program, DoctorFailsWhereAPartOfMvtpItselfIsMissing) {
  std::filesystem::create_directory(directory_.path("bin"));
  const std::string alone = directory_.path("bin/mvtp");
  std::filesystem::copy_file(MVTP_PROGRAM, alone);
  const Outcome outcome = shell("'" + alone + "' doctor");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.out, HasSubstr("MISSING  mvtp-sumo: without it not: coordinate, "));
}

}  // namespace
}  // namespace mvtp
