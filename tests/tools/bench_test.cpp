#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "planner/problem/plan_file.hpp"
#include "tests/tools/program_fixture.hpp"
#include "tools/bench/results.hpp"

namespace mvtp {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::Not;
using testing::SizeIs;

class BenchCommand : public Program {
 protected:
  BenchCommand() {
    std::filesystem::create_directories(directory_.path("in/deep"));
    (void)directory_.file("in/easy.yaml", instance("[20, 10, 0]"));
    (void)directory_.file("in/deep/turn.yaml", instance("[20, 14, 1.5]"));
  }

  /// Two cars in turn on one road; the first wants to get to `goal`.
  [[nodiscard]] static std::string instance(const std::string& goal) {
    return "agents:\n  - {name: agent0, start: [10, 10, 0], goal: " + goal +
           "}\n  - {name: agent1, start: [15, 10, 0], goal: [30, 10, 0]}\n"
           "map: {dimensions: [50, 50]}\n";
  }

  /// So many robots in so little room that no solver is done in a second.
  void add_hard_instances(int count) const {
    ASSERT_EQ(
        run("generate crowd --size 50 --robots 120 -q -o hard --count " + std::to_string(count))
            .exit_code,
        0);
  }

  [[nodiscard]] std::vector<ResultRow> results(const std::string& name = "r.csv") const {
    return read_results(directory_.path(name));
  }
  [[nodiscard]] static std::vector<RunKey> keys(std::vector<ResultRow> rows) {
    std::vector<RunKey> all;
    for (const ResultRow& row : rows) all.push_back(key_of(row));
    std::ranges::sort(all);
    return all;
  }
};

TEST_F(BenchCommand, RunsEachAlgorithmWithEachSeedOnEachInstance) {
  const Outcome outcome = run("bench in -o r.csv --algorithms escot,eccr --seeds 3,5 --jobs 2");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(outcome.err, HasSubstr("bench: 100 %"));
  EXPECT_THAT(outcome.err, HasSubstr("bench: 8 of 8 runs: 8 solved, 8 valid\n"));
  EXPECT_THAT(
      keys(results()),
      ElementsAre(RunKey("deep/turn.yaml", "eccr", 3), RunKey("deep/turn.yaml", "eccr", 5),
                  RunKey("deep/turn.yaml", "escot", 3), RunKey("deep/turn.yaml", "escot", 5),
                  RunKey("easy.yaml", "eccr", 3), RunKey("easy.yaml", "eccr", 5),
                  RunKey("easy.yaml", "escot", 3), RunKey("easy.yaml", "escot", 5)));
  for (const ResultRow& row : results()) {
    EXPECT_EQ(row.status, "solved");
    EXPECT_TRUE(row.valid);
    EXPECT_EQ(double(*row.makespan_steps), *row.makespan);  // steps of 1 s
    EXPECT_GE(*row.makespan, *row.lower_bound);
    EXPECT_GE(*row.flowtime, *row.makespan);
    EXPECT_LE(*row.first_solution, row.runtime);
    EXPECT_GT(row.peak_rss, 1.0);
    EXPECT_EQ(row.solved_seed, row.seed);
  }
  EXPECT_THAT(results().front().lower_bound, testing::Optional(15.0));
}

TEST_F(BenchCommand, HandsItsOptionsToSolverAndReferee) {
  ASSERT_EQ(run("bench in -o r.csv --vehicle cl-cbs --collision steps --plans kept -q").exit_code,
            0);
  ASSERT_THAT(results(), SizeIs(2));
  for (const ResultRow& row : results()) {
    EXPECT_TRUE(row.valid);
    EXPECT_NEAR(*row.makespan, double(*row.makespan_steps) * 2.118, 1e-3);
  }
  const Plan plan = read_plan(directory_.path("kept/deep/turn.escot.seed0.yaml"));
  EXPECT_EQ(plan.statistics.dt, 3 * 0.706);
  EXPECT_EQ(run("validate -q -i in/deep/turn.yaml -s kept/deep/turn.escot.seed0.yaml "
                "--vehicle cl-cbs --collision steps")
                .exit_code,
            0);
}

TEST_F(BenchCommand, FailuresAreRows) {
  (void)directory_.file("in/blocked.yaml", instance("[30, 11, 0]"));
  (void)directory_.file("in/garbage.yaml", "agents: 5\n");
  const Outcome outcome = run("bench in -o r.csv --jobs 2");
  EXPECT_EQ(outcome.exit_code, 0);
  std::vector<std::string> ends;
  for (const ResultRow& row : results()) {
    ends.push_back(row.instance + ": " + row.status + (row.valid ? ", valid" : ""));
  }
  EXPECT_THAT(ends, testing::UnorderedElementsAre(
                        "blocked.yaml: infeasible", "deep/turn.yaml: solved, valid",
                        "easy.yaml: solved, valid", "garbage.yaml: refused"));
  EXPECT_THAT(outcome.err, HasSubstr("4 of 4 runs: 1 infeasible, 1 refused, 2 solved, 2 valid\n"));
  EXPECT_THAT(outcome.err, HasSubstr("\nmvtp: blocked.yaml, escot, seed 0: "));
  EXPECT_THAT(outcome.err, HasSubstr("\nmvtp: garbage.yaml, escot, seed 0: "));
}

//   The system ends the solver after a second of computing.
TEST_F(BenchCommand, ACrashCostsOneRow) {
  add_hard_instances(1);
  const Outcome crashing = shell(std::string("ulimit -t 1; '") + MVTP_PROGRAM +
                                 "' bench hard in -o r.csv --algorithms eccr");
  EXPECT_EQ(crashing.exit_code, 0);
  EXPECT_THAT(crashing.err, HasSubstr("3 of 3 runs: 1 crashed, 2 solved, 2 valid\n"));
  EXPECT_THAT(crashing.err, HasSubstr("ex00.yaml, eccr, seed 0: "));
}

//   A plan that lies there from before is not taken for the solver's.
TEST_F(BenchCommand, UnsolvedRunsHaveNoPlan) {
  std::filesystem::create_directories(directory_.path("kept"));
  (void)directory_.file("kept/easy.escot.seed0.yaml", "schedule: {}\n");
  ASSERT_EQ(run("bench in/easy.yaml -o r.csv --time-limit 1e-9 --plans kept -q").exit_code, 0);
  ASSERT_THAT(results(), SizeIs(1));
  EXPECT_EQ(results()[0].status, "timeout");
  EXPECT_FALSE(results()[0].valid);
  EXPECT_EQ(results()[0].makespan, std::nullopt);
  EXPECT_THAT(results()[0].lower_bound, testing::Optional(15.0));
  EXPECT_FALSE(std::filesystem::exists(directory_.path("kept/easy.escot.seed0.yaml")));
}

TEST_F(BenchCommand, ResumeDoesOnlyWhatIsMissing) {
  ASSERT_EQ(run("bench in/easy.yaml -o r.csv -q").exit_code, 0);
  const std::string before = content_of(directory_.path("r.csv"));
  EXPECT_THAT(run("bench in/easy.yaml -o r.csv --resume").err, HasSubstr("nothing to do"));
  EXPECT_EQ(content_of(directory_.path("r.csv")), before);
  ASSERT_EQ(run("bench in/easy.yaml -o r.csv --resume --seeds 0-2 -q").exit_code, 0);
  EXPECT_THAT(content_of(directory_.path("r.csv")), testing::StartsWith(before));
  EXPECT_THAT(results(), SizeIs(3));
}

TEST_F(BenchCommand, RunsWithDifferentOptionsNeverShareATable) {
  ASSERT_EQ(run("bench in/easy.yaml -o r.csv -q --time-limit 5").exit_code, 0);
  const std::string more = "bench in -o r.csv --resume ";
  expect_refused(more,
                 "r.csv: has runs with --time-limit=5, not with no options; give the same, .*");
  expect_refused(
      more + "--time-limit 5 --vehicle cl-cbs",
      "r.csv: has runs with --time-limit=5, not with --time-limit=5 --vehicle=cl-cbs; .*");
  EXPECT_EQ(run(more + "--time-limit 5").exit_code, 0);
  EXPECT_THAT(results(), SizeIs(2));
}

//   The folder for what lies between solver and referee.
TEST_F(BenchCommand, WithoutATemporaryFolderNothingIsRecorded) {
  Outcome outcome = shell(std::string("TMPDIR=none '") + MVTP_PROGRAM + "' bench in -o r.csv");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err,
              MatchesRegex("mvtp: TMPDIR: names no folder [^\n]*; set it to another\n"));
}

TEST_F(BenchCommand, AFullDiskIsNoResult) {
  const std::string bench = std::string("'") + MVTP_PROGRAM + "' bench in/easy.yaml -q -o r.csv";
  const Outcome outcome = shell("trap '' XFSZ; ulimit -f 1; " + bench);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err,
              MatchesRegex("mvtp: [^\n]*: the disk is full; make room or set TMPDIR to "
                           "another folder, and use --resume\n"));
  EXPECT_EQ(shell("ls").out, "in\n");
  EXPECT_EQ(shell(bench + " --resume").exit_code, 0);
  EXPECT_THAT(results(), SizeIs(1));
}

//   Whole rows fill the file up to a few bytes before its limit of 8 blocks.
TEST_F(BenchCommand, AFullDiskCutsNoRowOff) {
  const std::string bench = std::string("'") + MVTP_PROGRAM + "' bench in/easy.yaml -q -o r.csv";
  ASSERT_EQ(shell(bench).exit_code, 0);
  ResultRow row = results().front();
  row.instance = "";
  std::string rows = content_of(directory_.path("r.csv"));
  row.instance = std::string(8 * 512 - 20 - rows.size() - to_csv(row).size(), 'x');
  rows += to_csv(row);
  (void)directory_.file("r.csv", rows);
  const Outcome outcome = shell("trap '' XFSZ; ulimit -f 8; " + bench + " --resume --seeds 1");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.err,
            "mvtp: r.csv: cannot be written: is the disk full? Make room and use --resume\n");
  EXPECT_EQ(content_of(directory_.path("r.csv")), rows);
}

TEST_F(BenchCommand, ShardsTogetherAreTheWhole) {
  for (const char* shard : {"1", "2", "3"}) {
    const std::string i = shard;
    ASSERT_EQ(run("bench in -o " + i + ".csv -q --seeds 0,1 --shard " + i + "/3").exit_code, 0);
  }
  ASSERT_EQ(run("bench merge 1.csv 2.csv 3.csv 1.csv -o all.csv").exit_code, 0);
  ASSERT_EQ(run("bench in -o whole.csv -q --seeds 0,1").exit_code, 0);
  EXPECT_THAT(results("3.csv"), IsEmpty());
  EXPECT_EQ(keys(results("all.csv")), keys(results("whole.csv")));
}

//   Killed while it works, and again interrupted, it loses no row; the last run ends the job.
TEST_F(BenchCommand, AKilledRunLosesNothing) {
  add_hard_instances(3);
  const std::string bench =
      std::string("'") + MVTP_PROGRAM +
      "' bench in hard -o r.csv --algorithms pbcr --time-limit 0.5 --resume -q";
  ASSERT_EQ(shell(bench + " & for i in $(seq 100); do sleep 0.1; grep -q hard r.csv && break; "
                          "done; kill -KILL $!; wait $!")
                .exit_code,
            137);
  const std::string after_kill = content_of(directory_.path("r.csv"));
  EXPECT_THAT(results(), SizeIs(testing::Ge(1U)));

  for (const std::string signal : {"TERM", "INT"}) {
    // Once it has started a run of its own, it listens to signals.
    const std::string at_work = "grep -q . /proc/$child/task/$child/children";
    const Outcome interrupted =
        shell(bench + " & child=$!; for i in $(seq 200); do " + at_work +
              " && break; sleep 0.05; done; kill -" + signal + " $child; wait $child");
    EXPECT_EQ(interrupted.exit_code, 130);
    EXPECT_THAT(content_of(directory_.path("r.csv")), testing::StartsWith(after_kill));
    for (const ResultRow& row : results()) EXPECT_NE(row.status, "crashed");  // it was us
  }

  EXPECT_EQ(shell(bench).exit_code, 0);
  EXPECT_THAT(content_of(directory_.path("r.csv")), testing::StartsWith(after_kill));
  EXPECT_THAT(keys(results()), AllOf(SizeIs(5), testing::BeginEndDistanceIs(5)));
}

TEST_F(BenchCommand, RefusesWhatItCannotDo) {
  (void)directory_.file("r.csv", results_header());
  (void)directory_.file("other.csv", "a,b\n1,2\n");
  expect_refused("bench", "bench: PATH is required; see mvtp bench --help");
  expect_refused("bench in", "bench: --output is required; see mvtp bench --help");
  expect_refused("bench none -o x.csv", "none: cannot be read: .*; check the path");
  expect_refused("bench in -o r.csv", "r.csv: exists; .*--resume.*");
  expect_refused("bench in -o other.csv --resume", "other.csv: is no results.csv; .*");
  expect_refused("bench in -o no/r.csv", "no/r.csv: cannot be written: .*");
  expect_refused("bench in -o x.csv --algorithms escot,magic", "--algorithms: is \"magic\"; .*");
  expect_refused("bench in -o x.csv --seeds 3-1", "--seeds: is \"3-1\"; .*");
  expect_refused("bench in -o x.csv --shard 0/3", "--shard: is \"0/3\"; give I/N .*");
  expect_refused("bench in -o x.csv --jobs 0", "bench: --jobs: is \"0\"; give a whole .*");
  expect_refused("bench in -o x.csv --time-limit nan", "bench: --time-limit: is \"nan\"; .*");
  expect_refused("bench in -o x.csv --plans r.csv", "r.csv: cannot make this folder .*");
  expect_refused("bench in -o x.csv --vehicle tank", "--vehicle: is the unknown preset .*");
  expect_refused("bench merge r.csv other.csv -o x.csv", "other.csv:1: has not the columns .*");
  expect_refused("bench merge none.csv -o x.csv", "none.csv: cannot be read: .*");
  EXPECT_FALSE(std::filesystem::exists(directory_.path("x.csv")));
}

}  // namespace
}  // namespace mvtp
