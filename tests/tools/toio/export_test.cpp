#include "tools/toio/plan/export.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "planner/problem/input_error.hpp"
#include "tests/tools/program_fixture.hpp"
#include "tests/tools/toio/crossing.hpp"
#include "tools/toio/plan/check.hpp"
#include "tools/toio/plan/release_graph.hpp"

namespace mvtp {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::Not;

TEST(ToioExport, TheLaterRobotWaitsForTheEarlierOneToLeave) {
  const Exported result = exported(crossing());
  ASSERT_THAT(result.problem, IsEmpty());
  EXPECT_THAT(result.run.robots[0].requirements, IsEmpty());
  ASSERT_THAT(result.run.robots[1].requirements, Not(IsEmpty()));
  for (const Requirement& r : result.run.robots[1].requirements) {
    EXPECT_EQ(r.robot, 0u);
    EXPECT_LT(r.left, r.segment);
  }
  EXPECT_THAT(find_problems(result.run), IsEmpty());
}

//   Without the wait both would be at the crossing at once.
TEST(ToioExport, RobotsThatMeetInThePlanAreRefused) {
  EXPECT_THAT(exported(crossing(0)).problem,
              MatchesRegex("a and b come closer than their margins .* s into the plan; .*"));
}

//   b comes to the crossing 0.8 s after a has left it, or 4.8 s after.
TEST(ToioExport, SegmentsAreCutFinerWhereRobotsPassClose) {
  EXPECT_EQ(exported(crossing(8), {.segment = 2.0}).run.timing.segment, 2.0);
  const Exported close = exported(crossing(4), {.segment = 2.0});
  EXPECT_THAT(close.problem, IsEmpty());
  EXPECT_LT(close.run.timing.segment, 2.0);
  EXPECT_THAT(find_problems(close.run), IsEmpty());
}

TEST(ToioExport, TheFileReadsBackAsItWasWritten) {
  const TemporaryDirectory directory;
  for (const DriveMode mode : {DriveMode::kTrack, DriveMode::kTarget, DriveMode::kList}) {
    ToioRun run = exported(crossing(), {.mode = mode, .cubes = {"toio-A1b", "AA:BB"}}).run;
    const ToioRun again = read_run(directory.file("run.json", to_json(run)));
    EXPECT_EQ(again.robots, run.robots);
    EXPECT_EQ(again.desk.mat, run.desk.mat);
    EXPECT_EQ(again.desk.facing, run.desk.facing);
    EXPECT_EQ(again.timing, run.timing);
    EXPECT_EQ(again.margins, run.margins);
    EXPECT_EQ(again.mode, run.mode);
    EXPECT_NEAR(again.frame.origin.x, run.frame.origin.x, 1e-9);
    EXPECT_NEAR(again.frame.scale, run.frame.scale, 1e-12);
    EXPECT_EQ(to_json(again), to_json(run));
    EXPECT_THAT(find_problems(again), IsEmpty());
  }
}

TEST(ToioExport, TheCsvHasALinePerFrame) {
  const ToioRun run = exported(crossing()).run;
  const std::string csv = to_csv(run);
  EXPECT_THAT(csv, testing::StartsWith("t_ms,robot,characteristic,hex\n0,a,motor,02 01 "));
  EXPECT_EQ(std::ranges::count(csv, '\n'),
            1 + std::ptrdiff_t(run.robots[0].frames.size() + run.robots[1].frames.size()));
}

/// The numbers of targets of the lists of robot a.
std::vector<std::size_t> list_sizes(int mtu) {
  std::vector<std::size_t> sizes;
  const Exported result = exported(crossing(), {.mode = DriveMode::kList, .mtu = mtu});
  for (const TimedFrame& frame : result.run.robots[0].frames) {
    EXPECT_LE(frame.write.bytes.size(), std::size_t(mtu - 3));
    const auto command = decode_command(Characteristic::kMotor, frame.write.bytes).value();
    const auto& list = std::get<GoThrough>(command);
    EXPECT_EQ(list.append, !sizes.empty());
    sizes.push_back(list.targets.size());
  }
  return sizes;
}

//   273 mm of path are 11 targets of 25 mm; 23 bytes hold two of them, 185 bytes 29.
TEST(ToioExport, ListsOfTargetsFitTheLink) {
  EXPECT_THAT(list_sizes(23), ElementsAre(2, 2, 2, 2, 2, 1));
  EXPECT_THAT(list_sizes(185), ElementsAre(11));
}

TEST(ToioExport, TheLastTargetHasTheAngleOfTheGoal) {
  const Exported result = exported(crossing(), {.mode = DriveMode::kTarget});
  const auto command =
      decode_command(Characteristic::kMotor, result.run.robots[1].frames.back().write.bytes);
  const Target target = std::get<GoTo>(command.value()).target;
  EXPECT_EQ(target.rule, AngleRule::kShorter);
  EXPECT_EQ(target.degrees, 90);  // heading up is 270 degrees, and the cube drives tail first
}

// What check finds ----------------------------------------------------------------------------

TEST(ToioCheck, AForgottenRequirementIsFound) {
  ToioRun run = exported(crossing()).run;
  run.robots[1].requirements.pop_back();
  EXPECT_THAT(find_problems(run),
              ElementsAre(MatchesRegex("b could meet a: its segment .* does not wait until .*")));
}

TEST(ToioCheck, ARequirementThatCouldBlockIsFound) {
  ToioRun run = exported(crossing()).run;
  run.robots[0].requirements = {{3, 1, 3}};
  EXPECT_THAT(find_problems(run), Contains(HasSubstr("a: segment 3 waits for segment 3 of b")));
}

TEST(ToioCheck, ABodyOffTheMatIsFound) {
  ToioRun run = exported(crossing()).run;
  run.desk.mat.max_x = 300;
  EXPECT_THAT(find_problems(run), Contains(HasSubstr("mm off the mat")));
}

TEST(ToioCheck, ALeapIsFound) {
  ToioRun run = exported(crossing()).run;
  for (std::size_t k = 40; k < run.robots[0].waypoints.size(); ++k) {
    run.robots[0].waypoints[k].pose.x += 3.0;
  }
  EXPECT_THAT(find_problems(run), Contains(HasSubstr("its speed changes by")));
}

TEST(ToioCheck, AFrameThatSaysOtherwiseIsFound) {
  ToioRun run = exported(crossing()).run;
  run.robots[0].frames[20].write.bytes[3] ^= 1;
  EXPECT_THAT(find_problems(run), ElementsAre(HasSubstr("turns the wheels otherwise")));
  run.robots[0].frames[20].write.bytes = {0x09};
  EXPECT_THAT(find_problems(run), ElementsAre(HasSubstr("is no command of a cube")));
  ToioRun targets = exported(crossing(), {.mode = DriveMode::kTarget}).run;
  targets.robots[0].frames[5].write.bytes[9] ^= 0x10;
  EXPECT_THAT(find_problems(targets), ElementsAre(HasSubstr("a target beside the path")));
}

// The release graph ---------------------------------------------------------------------------

/// Plays a run with every order of moves that the graph allows at random: robots step from segment
/// to segment, or dawdle. @return false if bodies met or nobody could move.
bool any_order_is_safe(const ToioRun& run, unsigned seed) {
  const Vehicle body = body_of(run.desk.cube, run.desk.facing, run.margins);
  std::vector<Reference> references;
  std::vector<double> reached;
  for (const RunRobot& robot : run.robots) {
    references.emplace_back(robot, run.desk);
    reached.push_back(0.0);
  }
  const auto arrived = [&](std::size_t i) { return reached[i] >= references[i].end(); };
  std::mt19937 dice(seed);
  for (int step = 0; step < 1'000'000; ++step) {
    std::vector<std::size_t> able;
    for (std::size_t i = 0; i < references.size(); ++i) {
      const double limit = released_until(run.robots[i].requirements, references, i, reached);
      if (reached[i] < limit) able.push_back(i);
    }
    if (able.empty()) break;
    const std::size_t i = able[dice() % able.size()];
    const double limit = released_until(run.robots[i].requirements, references, i, reached);
    reached[i] = std::min(limit, reached[i] + 0.05 * double(1 + dice() % 20));
    const OrientedBox mine = footprint(body, references[i].at(reached[i]).pose);
    for (std::size_t j = 0; j < references.size(); ++j) {
      if (j != i && separation(mine, footprint(body, references[j].at(reached[j]).pose)) < 0.0) {
        return false;
      }
    }
  }
  for (std::size_t i = 0; i < references.size(); ++i) {
    if (!arrived(i)) return false;
  }
  return true;
}

TEST(ToioReleaseGraph, AnyOrderThatItAllowsIsSafeAndEnds) {
  const ToioRun run = exported(crossing(4)).run;
  for (unsigned seed = 0; seed < 100; ++seed) EXPECT_TRUE(any_order_is_safe(run, seed)) << seed;
  ToioRun without = run;
  without.robots[1].requirements.clear();
  int unsafe = 0;
  for (unsigned seed = 0; seed < 100; ++seed) unsafe += any_order_is_safe(without, seed) ? 0 : 1;
  EXPECT_GT(unsafe, 5);  // so that the test can fail
}

// As a user runs it ---------------------------------------------------------------------------

using ToioExportProgram = Program;

TEST_F(ToioExportProgram, ThePapersFourRobotsAreExportedAndChecked) {
  const std::string instance = std::string(MVTP_SCENARIOS) + "/toio/four.yaml";
  ASSERT_EQ(run("solve -i " + instance + " -o plan.yaml -q").exit_code, 0);
  for (const std::string mat : {"simple", "collection-ring"}) {
    const Outcome outcome = run("toio export plan.yaml -i " + instance + " --mat " + mat +
                                " -o run.json --csv frames.csv");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("4 cubes, tail first"));
    EXPECT_EQ(run("toio check run.json").exit_code, 0);
  }
  const ToioRun read = read_run(directory_.path("run.json"));
  for (unsigned seed = 0; seed < 20; ++seed) EXPECT_TRUE(any_order_is_safe(read, seed)) << seed;
}

TEST_F(ToioExportProgram, CheckTellsWhatIsWrong) {
  ToioRun bad = exported(crossing()).run;
  bad.robots[1].requirements.pop_back();
  (void)directory_.file("run.json", to_json(bad));
  const Outcome outcome = run("toio check run.json");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.out, MatchesRegex("b could meet a: [^\n]*\n"));
}

TEST_F(ToioExportProgram, EachRobotNeedsACubeOfItsOwn) {
  const std::string instance = std::string(MVTP_SCENARIOS) + "/toio/four.yaml";
  ASSERT_EQ(run("solve -i " + instance + " -o plan.yaml -q").exit_code, 0);
  expect_refused(
      "toio export plan.yaml -i " + instance + " --mat simple -o run.json --cube a,b,a,c",
      "--cube: names \"a\" twice; name another cube for each robot");
  ToioRun twice = exported(crossing()).run;
  twice.robots[0].cube = twice.robots[1].cube = "toio-E1a";
  (void)directory_.file("run.json", to_json(twice));
  expect_refused("toio check run.json",
                 "run.json: robots.1..cube: is \"toio-E1a\", as robots.0.'s; give each robot .*");
}

TEST_F(ToioExportProgram, BadRunFilesAreNamed) {
  const std::string good = to_json(exported(crossing()).run);
  const auto refuse = [&](const std::string& what, const std::string& by, const std::string& why) {
    std::string text = good;
    const std::size_t at = text.find(what);
    ASSERT_NE(at, std::string::npos) << what;
    (void)directory_.file("run.json", text.replace(at, what.size(), by));
    expect_refused("toio check run.json", "run.json: " + why);
  };
  refuse("toio-run", "other", "is not a run file.*");
  refuse("\"version\": 1", "\"version\": 2", "version: is not 1; .*");
  refuse("\"t\":0.05", "\"t\":0.0", "robots.0..waypoints.1..t: is 0 s after 0 s; times must rise");
  refuse("\"deg\":180.0", "\"deg\":361", "robots.0..waypoints.0..deg: is 361 degrees; .*");
  refuse("\"x\":", "\"x\":null,\"z\":", "robots.0..waypoints.0..x: .*");
  refuse("\"hex\":\"02", "\"hex\":\"zz", "robots.0..frames.0..hex: is no list of bytes.*");
  refuse("\"robot\":\"a\"", "\"robot\":\"c\"", ".*requires.0..robot: is \"c\"; no robot has .*");
  refuse("\"quarter_turns\":0", "\"quarter_turns\":0.5", ".*quarter_turns: is 0.5; .*");
  refuse("\"mode\": \"track\"", "\"mode\": \"fly\"", "mode: is \"fly\"; choose track.*");
  refuse("\"control_ms\":50", "\"control_ms\":1", "timing.control_ms: is 1 ms; .*");
  refuse("\"id\": \"b\"", "\"id\": \"a\"", "robots.1..id: is \"a\", as robots.0.'s; .*");
  (void)directory_.file("run.json", good.substr(0, good.size() / 2));
  expect_refused("toio check run.json", "run.json: .*");
  expect_refused("toio check .", "[.]: is a directory; give a file");
}

TEST_F(ToioExportProgram, ExportRefusesWhatItCannotWrite) {
  (void)directory_.file("plan.yaml", "schedule: {a: [{x: 0, y: 0, yaw: 0}, {x: 1, y: 0, yaw: 0}]}");
  expect_refused("toio export plan.yaml --mat developer-all -o no/such/run.json", "no/such/.*");
  expect_refused("toio export plan.yaml --mat developer-all -o run.json --cube a,b",
                 "--cube: names 2 cubes for 1 robots; .*");
  expect_refused("toio export plan.yaml --mat developer-all -o run.json --mtu 5",
                 "toio: --mtu: .*");
  EXPECT_EQ(run("toio export plan.yaml --mat developer-all -o run.json -q").exit_code, 0);
}

}  // namespace
}  // namespace mvtp
