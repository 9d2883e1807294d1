#include "tools/toio/emulator/emulate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/tools/program_fixture.hpp"
#include "tests/tools/toio/crossing.hpp"
#include "tests/tools/toio/random_plans.hpp"

namespace mvtp {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;

EmulateOptions rough(std::uint64_t seed, bool gating) {
  EmulateOptions options{.loss = 0.02, .stalls_per_minute = 4.0, .seed = seed};
  options.player.gating = gating;
  return options;
}

/// Runs of each plan and setting: 4, or as many as MVTP_LONG_TESTS says.
std::uint64_t runs_per_plan() {
  const char* text = std::getenv("MVTP_LONG_TESTS");
  return text == nullptr ? 4 : std::strtoull(text, nullptr, 10);
}

// Cubes are blocked for 1 to 5 s, each four times a minute, and 2 % of all messages are lost.
TEST(ToioEmulate, CubesThatAreBlockedTouchNobody) {
  const std::vector<ToioRun> plans = random_runs(10);
  int touching_without = 0;
  double gated = 0.0;
  double ungated = 0.0;
  for (const ToioRun& run : plans) {
    for (std::uint64_t seed = 0; seed < runs_per_plan(); ++seed) {
      const EmulateReport report = emulate(run, rough(seed, true));
      EXPECT_THAT(report.touching, IsEmpty()) << "seed " << seed;
      EXPECT_TRUE(report.finished) << "seed " << seed;
      touching_without += emulate(run, rough(seed, false)).touching.empty() ? 0 : 1;
    }
    EmulateOptions calm{.loss = 0.02};
    gated += emulate(run, calm).duration;
    calm.player.gating = false;
    ungated += emulate(run, calm).duration;
  }
  EXPECT_GT(touching_without, 0);  // so that the test can fail
  EXPECT_LE(gated, 1.05 * ungated);
}

TEST(ToioEmulate, TheCubesStayWithinTheirMargins) {
  const Exported result = exported(crossing());
  const EmulateReport report = emulate(result.run, {.loss = 0.02});
  EXPECT_TRUE(report.finished);
  EXPECT_LT(report.most_lateral(), 0.005);
  EXPECT_LT(report.most_along(), 0.0065);
  EXPECT_LT(report.duration, 1.1 * result.run.robots[1].waypoints.back().time + 0.5);
}

TEST(ToioEmulate, TheSameSeedGivesTheSameRun) {
  const ToioRun run = exported(crossing()).run;
  const EmulateReport a = emulate(run, rough(3, true));
  const EmulateReport b = emulate(run, rough(3, true));
  EXPECT_EQ(a.tracks, b.tracks);
  EXPECT_NE(a.tracks, emulate(run, rough(4, true)).tracks);
}

//   There and back: the cube stops at the cusp and reverses.
TEST(ToioEmulate, CubesReverse) {
  std::vector<PlannedRobot> robots = {crossing()[0]};
  robots[0].legs.clear();
  Pose pose = robots[0].start;
  for (const Arc& arc : {Arc{5.0, 0.2}, Arc{-4.0, -0.3}, Arc{6.0, 0.1}}) {
    for (int i = 0; i < 5; ++i) {
      const Arc part{arc.length / 5, arc.curvature};
      robots[0].legs.push_back({pose, part, {}});
      pose = drive(pose, part);
    }
  }
  const Exported result = exported(robots);
  ASSERT_THAT(result.problem, IsEmpty());
  const EmulateReport report = emulate(result.run, {});
  EXPECT_TRUE(report.finished);
  EXPECT_LT(report.most_lateral(), 0.005);
  EXPECT_LT(distance(report.tracks[0].back(), result.run.frame.to_desk(pose)), 0.008);
}

// The player by itself ------------------------------------------------------------------------

/// A player of the crossing whose robots are told that they are where their clocks are.
struct Ideal {
  explicit Ideal(const ToioRun& the_run) : run(the_run), player(run, {.lag = 0.0}) {}

  void tick(double until, const std::vector<bool>& alive) {
    for (; now < until; now += 0.05) {
      for (std::size_t i = 0; i < run.robots.size(); ++i) {
        if (alive[i]) report(i, player.clock(i));
      }
      writes = player.tick(now);
    }
  }
  void report(std::size_t i, double at) {
    const MatPose mat = rounded(run.desk.to_mat(player.reference(i).at(at).pose));
    player.receive(
        i,
        PositionId{std::uint16_t(mat.x), std::uint16_t(mat.y), std::uint16_t(mat.degrees), 0, 0, 0},
        now);
  }
  [[nodiscard]] WheelUnits speeds(std::size_t i) const {
    const auto command = decode_command(writes[i]->to, writes[i]->bytes);
    return std::get<DriveFor>(command.value()).speed;
  }

  ToioRun run;
  Player player;
  double now = 0.0;
  std::vector<std::optional<Write>> writes;
};

TEST(ToioPlayer, ASilentCubeStopsAndHoldsUpOnlyWhoNeedsItsPlace) {
  Ideal ideal(exported(crossing()).run);
  ideal.tick(0.5, {true, true});
  EXPECT_NE(ideal.speeds(0), (WheelUnits{}));
  ideal.tick(8.0, {false, true});
  EXPECT_EQ(ideal.speeds(0), (WheelUnits{}));
  EXPECT_EQ(ideal.player.outcome(0).fault, Fault::kSilent);
  EXPECT_GT(ideal.player.clock(1), 3.0);  // b goes up to the crossing, and not on it
  EXPECT_LT(ideal.player.reference(1).at(ideal.player.clock(1)).pose.y,
            ideal.player.reference(0).at(0.5).pose.y - 0.02);
  ideal.tick(30.0, {true, true});
  EXPECT_TRUE(ideal.player.finished());
}

TEST(ToioPlayer, ALostLinkEndsTheRunOfTheOthersInOrder) {
  Ideal ideal(exported(crossing()).run);
  ideal.tick(0.5, {true, true});
  ideal.player.lose(0);
  ideal.tick(20.0, {false, true});
  EXPECT_FALSE(ideal.writes[0]);
  EXPECT_EQ(ideal.speeds(1), (WheelUnits{}));
  EXPECT_TRUE(ideal.player.stuck(ideal.now));
  EXPECT_FALSE(ideal.player.finished());
}

TEST(ToioPlayer, ALinkThatIsBackGoesOn) {
  Ideal ideal(exported(crossing()).run);
  ideal.tick(0.5, {true, true});
  ideal.player.lose(0);
  ideal.tick(3.0, {false, true});
  ideal.player.regain(0, ideal.now);
  ideal.tick(30.0, {true, true});
  EXPECT_TRUE(ideal.player.finished());
}

//   A second of rest, then it goes on.
TEST(ToioPlayer, ACubeThatBumpsIntoSomethingStopsForAWhile) {
  Ideal ideal(exported(crossing()).run);
  ideal.tick(1.0, {true, true});
  ideal.player.receive(0, Motion{.collision = true}, ideal.now);
  ideal.tick(1.9, {true, true});
  EXPECT_EQ(ideal.player.outcome(0).fault, Fault::kBumped);
  EXPECT_EQ(ideal.speeds(0), (WheelUnits{}));
  ideal.tick(30.0, {true, true});
  EXPECT_TRUE(ideal.player.finished());
}

TEST(ToioPlayer, APauseStopsAllAndGoesOnAfterwards) {
  Ideal ideal(exported(crossing()).run);
  ideal.tick(1.0, {true, true});
  ideal.player.pause(true);
  ideal.tick(40.0, {true, true});
  EXPECT_EQ(ideal.speeds(0), (WheelUnits{}));
  EXPECT_FALSE(ideal.player.stuck(ideal.now));
  ideal.player.pause(false);
  ideal.tick(70.0, {true, true});
  EXPECT_TRUE(ideal.player.finished());
}

TEST(ToioPlayer, ACubeThatIsTakenAwayStops) {
  Ideal ideal(exported(crossing()).run);
  ideal.tick(1.0, {true, true});
  ideal.report(0, ideal.player.reference(0).end());
  ideal.writes = ideal.player.tick(ideal.now);
  EXPECT_EQ(ideal.player.outcome(0).fault, Fault::kOffPath);
  EXPECT_EQ(ideal.speeds(0), (WheelUnits{}));
  ideal.player.receive(0, PositionMissed{}, ideal.now);
  (void)ideal.player.tick(ideal.now);
  EXPECT_EQ(ideal.player.outcome(0).fault, Fault::kOffMat);
}

TEST(ToioPlayer, EveryCommandEndsByItself) {
  Ideal ideal(exported(crossing()).run);
  for (double until = 0.05; until < 12.0; until += 0.05) {
    ideal.tick(until, {true, true});
    for (const auto& write : ideal.writes) {
      const auto command = decode_command(write->to, write->bytes);
      EXPECT_EQ(std::get<DriveFor>(command.value()).tens_of_ms, 25);
    }
  }
}

// As a user runs it ---------------------------------------------------------------------------

using ToioEmulateProgram = Program;

TEST_F(ToioEmulateProgram, TheReleaseGraphIsWhatKeepsBlockedCubesApart) {
  (void)directory_.file("run.json", to_json(exported(crossing()).run));
  const std::string command = "toio emulate run.json --stall 12:2-4 --loss 2 --delay 130 --runs 10";
  const Outcome gated = run(command + " --report report.json");
  EXPECT_EQ(gated.exit_code, 0) << gated.out << gated.err;
  EXPECT_THAT(gated.out, HasSubstr("10 of 10 runs finished untouched; 0 touching, 0 not "));
  EXPECT_THAT(content_of(directory_.path("report.json")), HasSubstr("\"clearance_least_mm\""));
  const Outcome ungated = run(command + " --no-gating");
  EXPECT_EQ(ungated.exit_code, 1);
  EXPECT_THAT(ungated.out, HasSubstr("TOUCHING: a and b"));
}

//   The paper's path: coordinates sent again and again; a cube comes within 15 dots of them.
TEST_F(ToioEmulateProgram, TargetsNeedWiderMargins) {
  (void)directory_.file("run.json", to_json(exported(crossing()).run));
  expect_refused("toio emulate run.json --mode target",
                 "run.json: has margins of 5.0 mm, but .* export with --margin-lateral 20.4 .*");
  const Exported result = exported_for_targets();
  ASSERT_THAT(result.problem, IsEmpty());
  (void)directory_.file("wide.json", to_json(result.run));
  const Outcome outcome = run("toio emulate wide.json --mode target --runs 5 --stall 4:1-5");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out;

  EmulateOptions options;
  options.player.mode = DriveMode::kTarget;
  const EmulateReport report = emulate(result.run, options);
  for (std::size_t i = 0; i < report.tracks.size(); ++i) {
    const Pose goal = result.run.desk.to_desk(result.run.robots[i].waypoints.back().pose);
    EXPECT_LT(distance(report.tracks[i].back(), goal), 0.0204);
    EXPECT_LT(std::abs(wrap_to_pi(report.tracks[i].back().theta - goal.theta)), 0.1);
  }
}

TEST_F(ToioEmulateProgram, BadWordsAreRefused) {
  (void)directory_.file("run.json", to_json(exported(crossing()).run));
  expect_refused("toio emulate run.json --stall 1:5-2", "--stall: is \"1:5-2\"; give RATE:.*");
  expect_refused("toio emulate run.json --stall a", "--stall: is \"a\"; .*");
  expect_refused("toio emulate run.json --delay -1", "toio: --delay: is \"-1\"; .*");
  expect_refused("toio emulate run.json --report no/such", "no/such: .*");
  ToioRun bad = exported(crossing()).run;
  bad.robots[1].requirements.pop_back();
  (void)directory_.file("bad.json", to_json(bad));
  expect_refused("toio emulate bad.json", "bad.json: b could meet a: .*; see mvtp toio check");
}

}  // namespace
}  // namespace mvtp
