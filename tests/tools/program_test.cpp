#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "tests/tools/program_fixture.hpp"

namespace mvtp {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::StartsWith;

const std::string kInstance = R"(agents:
  - {name: agent0, start: [10, 10, 0], goal: [12, 10, 0]}
  - {name: agent1, start: [30, 10, 0], goal: [30, 10, 0]}
map:
  dimensions: [50, 50]
  obstacles: [[40, 40]]
)";

const std::string kPlan = R"(schedule:
  agent0:
    - {x: 10, y: 10, yaw: 0, t: 0}
    - {x: 11, y: 10, yaw: 0, t: 1, v: 1, phi: 0}
    - {x: 12, y: 10, yaw: 0, t: 2, v: 1, phi: 0}
  agent1:
    - {x: 30, y: 10, yaw: 0, t: 0}
)";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

TEST_F(Program, VersionNamesTheLibraries) {
  const Outcome outcome = run("--version");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out,
              MatchesRegex("mvtp [0-9.]+\nbuilt against SUMO [^,]+, OMPL [0-9.]+, FCL [0-9.]+\n"));
}

TEST_F(Program, HelpListsTheCommands) {
  const Outcome outcome = run("--help");
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* command : {"validate", "coordinate", "compare"}) {
    EXPECT_THAT(outcome.out, HasSubstr(std::string("\n  ") + command + " "));
  }
  EXPECT_THAT(outcome.err, IsEmpty());
}

TEST_F(Program, HelpOfACommandHasGroupsAndUnits) {
  const Outcome outcome = run("validate --help");
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* text : {"\nInput:", "\nInstance:", "\nRules:", "[s]", "[continuous]"}) {
    EXPECT_THAT(outcome.out, HasSubstr(text));
  }
}

TEST_F(Program, WrongUsageIsOneLine) {
  expect_refused("", ".*required.*; see mvtp --help");
  expect_refused("fly", "fly: is no command of mvtp; see mvtp --help");
  expect_refused("validate", "validate: --instance is required; see mvtp validate --help");
  expect_refused("validate -i a -s b --fly", "validate: .*--fly.*; see mvtp validate --help");
  expect_refused("solve --output= --instance=a", "a: cannot be read: .*");
  expect_refused("validate --instance= -s b", ": cannot be read: .*");
  expect_refused("solve a.yaml", "solve: a.yaml was not expected; see mvtp solve --help");
  expect_refused("validate -i a -s b --yaw up",
                 "validate: --yaw: is \"up\"; choose ccw.cw; see mvtp validate --help");
  expect_refused(
      "validate -i a -s b --dt nan",
      "validate: --dt: is \"nan\"; give a number from 0.001 to 1e.06; see mvtp validate --help");
  expect_refused("validate -i a -s b --vehicle tank",
                 "--vehicle: is the unknown preset \"tank\"; choose escot or cl-cbs");
}

TEST_F(Program, SlipsAreAnsweredWithTheNearestWord) {
  expect_refused("slove -i a", "slove: is no command of mvtp; did you mean solve. see mvtp --help");
  expect_refused("solve -i a --outptu=b",
                 "solve: --outptu was not expected; did you mean --output. see mvtp solve --help");
  expect_refused("solve --instanec a", "solve: --instanec was not expected; did you mean .*");
  expect_refused("solve -i a -a escto",
                 "solve: --algorithm: is \"escto\"; did you mean escot. choose escot.pbcr.*");
  expect_refused("validate -i a -s b --yaw CW",
                 "validate: --yaw: is \"CW\"; did you mean cw. choose ccw.cw; .*");
  expect_refused("generate dens -o out", "generate: suite: is \"dens\"; did you mean dense. .*");
  expect_refused("toio fitt", "toio: fitt was not expected; did you mean fit. .*");
  (void)directory_.file("p.yaml", kPlan);
  expect_refused("toio fit p.yaml --mat simpel",
                 "--mat: is \"simpel\", neither a mat nor a file; did you mean simple. .*");
}

TEST_F(Program, ValidPlansGiveZero) {
  (void)directory_.file("i.yaml", kInstance);
  (void)directory_.file("p.yaml", kPlan);
  const Outcome outcome = run("validate -i i.yaml -s p.yaml");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.out, "valid: 2 agents, makespan 2 steps = 2.00 s, flowtime 2.00 s\n");
  EXPECT_THAT(outcome.err, IsEmpty());
  EXPECT_THAT(run("validate -i i.yaml -s p.yaml --quiet").out, IsEmpty());
}

TEST_F(Program, InvalidPlansGiveOneAndALinePerViolation) {
  (void)directory_.file("i.yaml", kInstance);
  (void)directory_.file("p.yaml", replaced(kPlan, "{x: 30, y: 10", "{x: 14, y: 10"));
  const Outcome outcome = run("validate -i i.yaml -s p.yaml");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.out,
              MatchesRegex("start: agent1: begins 16.0000 m [^\n]*\n"
                           "goal: agent1: ends 16.0000 m [^\n]*\n"
                           "robot overlap: agent0 and agent1: overlap by 1.0000 m [^\n]*\n"));
  const Outcome quiet = run("validate -i i.yaml -s p.yaml -q");
  EXPECT_EQ(quiet.exit_code, 1);
  EXPECT_THAT(quiet.out + quiet.err, IsEmpty());
}

//   The circle lies between the two poses of the only step.
TEST_F(Program, TheCollisionRuleIsTheUsersChoice) {
  (void)directory_.file(
      "i.yaml", "vehicle: {max_speed: 10}\n" + replaced(replaced(kInstance, "[12, 10", "[19, 10"),
                                                        "[[40, 40]]", "[[15.5, 10, 0.5]]"));
  (void)directory_.file("p.yaml",
                        "schedule:\n"
                        "  agent0: [{x: 10, y: 10, yaw: 0}, {x: 19, y: 10, yaw: 0}]\n"
                        "  agent1: [{x: 30, y: 10, yaw: 0}]\n");
  EXPECT_EQ(run("validate -i i.yaml -s p.yaml --collision steps").exit_code, 0);
  EXPECT_EQ(run("validate -i i.yaml -s p.yaml --collision continuous").exit_code, 1);
  EXPECT_EQ(run("validate -i i.yaml -s p.yaml").exit_code, 1);
}

//   The paper's car moves 1 m in a step, that of CL-CBS 2.118 m.
TEST_F(Program, TheVehicleIsTheUsersChoice) {
  (void)directory_.file("i.yaml", replaced(kInstance, "[12, 10", "[12.1, 10"));
  (void)directory_.file("p.yaml",
                        "schedule:\n"
                        "  agent0: [{x: 10, y: 10, yaw: 0}, {x: 12.1, y: 10, yaw: 0}]\n"
                        "  agent1: [{x: 30, y: 10, yaw: 0}]\n");
  EXPECT_EQ(run("validate -i i.yaml -s p.yaml").exit_code, 1);
  EXPECT_EQ(run("validate -i i.yaml -s p.yaml --vehicle cl-cbs").exit_code, 0);
  EXPECT_EQ(run("validate -i i.yaml -s p.yaml --dt 2.2").exit_code, 0);
}

TEST_F(Program, OfManyRunsTheSeedThatSolvedIsTold) {
  (void)directory_.file("i.yaml", kInstance);
  EXPECT_THAT(run("solve -i i.yaml --seed 5 --runs 3").out, HasSubstr(" s with seed 5\n"));
  EXPECT_THAT(run("solve -i i.yaml --seed 5").out, testing::Not(HasSubstr("seed")));
}

//   The start of agent1 lies 5 cm inside the circle.
TEST_F(Program, InitialOverlapsAreRefusedUnlessAllowed) {
  (void)directory_.file("i.yaml", replaced(replaced(kInstance, "goal: [30", "goal: [34"),
                                           "[[40, 40]]", "[[31, 11.75]]"));
  expect_refused("solve -i i.yaml -o p.yaml", "i.yaml: agents.1..start: .* by 0.05 m; move .*");
  const Outcome solved = run("solve -i i.yaml -o p.yaml --initial-overlap allow");
  EXPECT_EQ(solved.exit_code, 0) << solved.err;
  EXPECT_THAT(solved.out, HasSubstr("; allowed: start of agent1 in obstacles[0] by 0.05 m\n"));
  EXPECT_THAT(
      content_of(directory_.path("p.yaml")),
      HasSubstr("  initial_overlaps:\n    - \"start of agent1 in obstacles[0] by 0.05 m\"\n"));
  const Outcome allowed = run("validate -i i.yaml -s p.yaml --initial-overlap allow");
  EXPECT_EQ(allowed.exit_code, 0);
  EXPECT_THAT(allowed.out, HasSubstr("; allowed: start of agent1 in obstacles[0] by 0.05 m\n"));
  EXPECT_EQ(run("validate -i i.yaml -s p.yaml").exit_code, 1);
  expect_refused("solve -i i.yaml --initial-overlap maybe", "solve: --initial-overlap: .*");

  EXPECT_EQ(run("bench i.yaml -o refused.csv").exit_code, 0);
  EXPECT_THAT(content_of(directory_.path("refused.csv")), HasSubstr(",infeasible,false,"));
  const Outcome bench = run("bench i.yaml -o allowed.csv --initial-overlap allow");
  EXPECT_THAT(content_of(directory_.path("allowed.csv")), HasSubstr(",solved,true,"));
  EXPECT_THAT(bench.err, HasSubstr("1 valid; in 1 an initial overlap is allowed\n"));
}

//   What was solved for the car of CL-CBS is judged and shown as such, without saying so again.
TEST_F(Program, ThePlanRecordsItsVehicle) {
  (void)directory_.file("i.yaml", kInstance);
  ASSERT_EQ(run("solve -i i.yaml -o p.yaml --vehicle cl-cbs -q").exit_code, 0);
  EXPECT_THAT(content_of(directory_.path("p.yaml")), HasSubstr("\nvehicle: {preset: cl-cbs}\n"));
  const Outcome judged = run("validate -i i.yaml -s p.yaml");
  EXPECT_EQ(judged.exit_code, 0);
  EXPECT_THAT(judged.out, HasSubstr(", with the vehicles of the plan in place of the instance's"));
  const Outcome named = run("validate -i i.yaml -s p.yaml --vehicle cl-cbs");
  EXPECT_EQ(named.exit_code, 0);
  EXPECT_THAT(named.out, testing::Not(HasSubstr("in place of")));

  ASSERT_EQ(run("view p.yaml -i i.yaml -o named.html --vehicle cl-cbs").exit_code, 0);
  ASSERT_EQ(run("view p.yaml -i i.yaml -o view.html").exit_code, 0);
  EXPECT_EQ(content_of(directory_.path("view.html")), content_of(directory_.path("named.html")));
}

//   The paper's car turns more tightly than that of CL-CBS may.
TEST_F(Program, APlanIsJudgedByTheVehicleThatItRecords) {
  (void)directory_.file("i.yaml", "vehicle: {preset: cl-cbs}\n" +
                                      replaced(kInstance, "[12, 10, 0]", "[13, 13, 1.5708]"));
  ASSERT_EQ(run("solve -i i.yaml -o p.yaml --vehicle escot -q").exit_code, 0);
  EXPECT_EQ(run("validate -i i.yaml -s p.yaml").exit_code, 0);
  EXPECT_EQ(run("validate -i i.yaml -s p.yaml --vehicle cl-cbs").exit_code, 1);
}

TEST_F(Program, CubesFollowTheVehicleOfThePlan) {
  (void)directory_.file("i.yaml", kInstance);
  ASSERT_EQ(run("solve -i i.yaml -o p.yaml --vehicle cl-cbs -q").exit_code, 0);
  const auto fit = [&](const std::string& more) {
    return run("toio fit p.yaml --mat collection-ring " + more).out;
  };
  EXPECT_EQ(fit(""), fit("--vehicle cl-cbs"));
  EXPECT_EQ(fit("-i i.yaml"), fit("-i i.yaml --vehicle cl-cbs"));
  EXPECT_NE(fit(""), fit("--vehicle escot"));
}

//   A drive up and to the right: along the heading 0.785398 rad only if that is counter-clockwise.
TEST_F(Program, TheSenseOfYawIsTheUsersChoice) {
  const auto written = [&](const std::string& yaw) {
    (void)directory_.file("i.yaml", "agents: [{start: [10, 10, " + yaw + "], goal: [10.5, 10.5, " +
                                        yaw + "]}]\nmap: {dimensions: [50, 50]}\n");
    (void)directory_.file("p.yaml", "schedule: {agent0: [{x: 10, y: 10, yaw: " + yaw +
                                        "}, {x: 10.5, y: 10.5, yaw: " + yaw + "}]}\n");
  };
  written("0.785398");
  EXPECT_EQ(run("validate -i i.yaml -s p.yaml").exit_code, 0);
  EXPECT_EQ(run("validate -i i.yaml -s p.yaml --yaw cw").exit_code, 1);
  written("-0.785398");
  EXPECT_EQ(run("validate -i i.yaml -s p.yaml --yaw ccw").exit_code, 1);
  EXPECT_EQ(run("validate -i i.yaml -s p.yaml --yaw cw").exit_code, 0);
}

TEST_F(Program, BadInputIsOneLineThatNamesThePlace) {
  (void)directory_.file("i.yaml", kInstance);
  (void)directory_.file("p.yaml", kPlan);
  (void)directory_.file("empty", "");
  (void)directory_.file("binary", std::string("\x7f"
                                              "ELF\0\0",
                                              6));
  (void)directory_.file("garbage", std::string(10'000'000, 'z'));
  (void)directory_.file("cut.yaml", kInstance.substr(0, kInstance.find("goal: [12") + 7));
  (void)directory_.file("nan.yaml", replaced(kInstance, "[12, 10, 0]", "[12, .nan, 0]"));
  std::filesystem::create_directory(directory_.path("folder"));

  const auto instance = [](const std::string& file) { return "validate -s p.yaml -i " + file; };
  expect_refused(instance("none"),
                 "none: cannot be read: No such file or directory; check the path");
  expect_refused(instance("folder"), "folder: is a directory; give a file");
  expect_refused(instance("empty"), "empty: is empty; give another file");
  expect_refused(instance("binary"), "binary: is not a text file .byte 0x7f at offset 0.; .*");
  expect_refused(instance("garbage"), "garbage: is not an instance file .*");
  expect_refused(instance("p.yaml"), "p.yaml: is not an instance file .*");
  expect_refused(instance("/dev/zero"), "/dev/zero: is not a text file .*");
  expect_refused(instance("cut.yaml"), "cut.yaml: .*cut off.*");
  expect_refused(instance("nan.yaml"),
                 "nan.yaml: agents.0..goal.1.: is \".nan\"; give a finite number .m.");
  expect_refused("validate -i i.yaml -s i.yaml", "i.yaml: is not a plan file .*");
  expect_refused("validate -i i.yaml -s none", "none: cannot be read: .*");
  EXPECT_EQ(directory_.size(), 8);  // nothing was written
}

TEST_F(Program, ResultsThatCannotBePrintedAreNotDone) {
  (void)directory_.file("i.yaml", kInstance);
  (void)directory_.file("p.yaml", kPlan);
  for (const char* arguments : {"validate -i i.yaml -s p.yaml", "--version", "solve --help"}) {
    const Outcome outcome =
        shell(std::string("'") + MVTP_PROGRAM + "' " + arguments + " >/dev/full");
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_THAT(outcome.err, MatchesRegex("mvtp: standard output: [^\n]*\n")) << arguments;
  }
}

//   Two robots face each other, 20 m apart, each on its way to where the other one stands.
const std::string kHeadOn = R"(agents:
  - {name: a, start: [15, 25, 0], goal: [35, 25, 0]}
  - {name: b, start: [35, 25, 3.14159], goal: [15, 25, 3.14159]}
map:
  dimensions: [50, 50]
  obstacles: []
)";

TEST_F(Program, SolveWritesAPlanThatTheRefereeAccepts) {
  (void)directory_.file("i.yaml", kHeadOn);
  for (const char* algorithm : {"escot", "eccr"}) {
    const Outcome outcome = run(std::string("solve -i i.yaml -o p.yaml -a ") + algorithm);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, MatchesRegex("solved: 2 agents, makespan 2[0-9] steps = [^\n]*\n"));
    EXPECT_EQ(run("validate -i i.yaml -s p.yaml").exit_code, 0);
  }
}

TEST_F(Program, SolveGivesTheSameBytesButForTheRunTime) {
  (void)directory_.file("i.yaml", kHeadOn);
  const auto plan = [this] {
    EXPECT_EQ(run("solve -i i.yaml -o p.yaml --seed 5 -q").exit_code, 0);
    std::string text = content_of(directory_.path("p.yaml"));
    const std::size_t begin = text.find("runtime:");
    EXPECT_NE(begin, std::string::npos);
    return text.erase(begin, text.find_first_of(",\n", begin) - begin);
  };
  EXPECT_EQ(plan(), plan());
}

TEST_F(Program, SolveWritesNothingWhenItFails) {
  (void)directory_.file("i.yaml", kHeadOn);
  const Outcome outcome = run("solve -i i.yaml -o p.yaml --time-limit 1e-9");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err, "mvtp: i.yaml: not solved (timeout): the time limit ended the search\n");
  EXPECT_FALSE(std::filesystem::exists(directory_.path("p.yaml")));
}

TEST_F(Program, SolveRefusesBadInput) {
  (void)directory_.file("i.yaml", kHeadOn);
  (void)directory_.file("same.yaml", replaced(kHeadOn, "start: [35", "start: [15"));
  expect_refused("solve -i none.yaml", "none.yaml: .*");
  expect_refused("solve -i same.yaml", "same.yaml: agents.*overlap.*");
  expect_refused("solve -i i.yaml -o no/such/p.yaml", "no/such/p.yaml: .*");
  expect_refused("solve -i i.yaml -a magic",
                 "solve: --algorithm: is \"magic\"; choose escot.*; see mvtp solve --help");
  expect_refused("solve -i i.yaml --seed -1",
                 "solve: --seed: is \"-1\"; give a whole number from 0 to [0-9]+; .*");
  expect_refused("solve -i i.yaml --runs 0",
                 "solve: --runs: is \"0\"; give a whole number > 0; see mvtp solve --help");
  expect_refused("solve -i i.yaml --time-limit -3",
                 "solve: --time-limit: is \"-3\"; give a finite number > 0; .*");
}

/// Eight robots across a circle: improved for as long as one waits.
std::string circle_of_eight() {
  std::string text = "agents:\n";
  for (int i = 0; i < 8; ++i) {
    const double a = 0.785398 * i;
    text += "  - {start: [" + std::to_string(25 + 15 * std::cos(a)) + ", " +
            std::to_string(25 + 15 * std::sin(a)) + ", " + std::to_string(a + 3.141593) +
            "], goal: [" + std::to_string(25 - 15 * std::cos(a)) + ", " +
            std::to_string(25 - 15 * std::sin(a)) + ", " + std::to_string(a + 3.141593) + "]}\n";
  }
  return text + "map: {dimensions: [50, 50]}\n";
}

//   A signal after two seconds, long after the first plan and long before the last.
TEST_F(Program, AnInterruptedSearchWritesTheBestPlanSoFar) {
  (void)directory_.file("i.yaml", circle_of_eight());
  for (const std::string signal : {"INT", "TERM"}) {
    const Outcome outcome = shell("timeout --preserve-status -s " + signal + " 2 '" + MVTP_PROGRAM +
                                  "' solve -i i.yaml -a escot-star --gap 0 --time-limit 250 "
                                  "-o p.yaml --statistics s.yaml");
    EXPECT_EQ(outcome.exit_code, 130);
    EXPECT_THAT(outcome.out, StartsWith("solved: 8 agents, "));
    EXPECT_EQ(outcome.err, "mvtp: i.yaml: interrupted; this is the best plan so far\n");
    EXPECT_EQ(run("validate -i i.yaml -s p.yaml").exit_code, 0);
    EXPECT_THAT(content_of(directory_.path("s.yaml")), HasSubstr("status: solved"));
    std::filesystem::remove(directory_.path("p.yaml"));
  }
}

//   Two cars head on in a lane: nobody ever finds a plan.
TEST_F(Program, AnInterruptedSearchWithoutAPlanSaysSo) {
  (void)directory_.file("i.yaml",
                        "agents:\n"
                        "  - {start: [2, 2, 0], goal: [40, 2, 0]}\n"
                        "  - {start: [42, 2, 3.141593], goal: [4, 2, 3.141593]}\n"
                        "map: {dimensions: [46, 4], bounds: footprint}\n");
  const Outcome outcome =
      shell(std::string("timeout --preserve-status -s TERM 1 '") + MVTP_PROGRAM +
            "' solve -i i.yaml -a pbcr --runs 100000 --time-limit 250 -o p.yaml");
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_EQ(outcome.err,
            "mvtp: i.yaml: interrupted, and not solved (timeout): a signal ended the search\n");
  EXPECT_FALSE(std::filesystem::exists(directory_.path("p.yaml")));
}

TEST_F(Program, LongWorkTellsWhatIsLeft) {
  (void)directory_.file("i.yaml", circle_of_eight());
  const std::string solve = "solve -i i.yaml -a escot-star --gap 0 --time-limit 2 ";
  EXPECT_THAT(run(solve).err, testing::ContainsRegex("solve: [1-9]0 %, [12] s left\n"));
  EXPECT_THAT(run(solve + "-q").err, IsEmpty());
  EXPECT_THAT(run("generate typical -o suite").err, testing::ContainsRegex("generate: .*s left"));
}

//   The signal comes after the first of 29,000 files and long before the last.
TEST_F(Program, GenerateEndsWithTheCodeOfAnInterrupt) {
  for (const std::string signal : {"INT", "TERM"}) {
    const Outcome outcome = shell("timeout --preserve-status -s " + signal + " 3 '" + MVTP_PROGRAM +
                                  "' generate dense --count 1000 -q -o out");
    EXPECT_EQ(outcome.exit_code, 130);
  }
  ASSERT_TRUE(std::filesystem::exists(directory_.path("out")));
  for (const auto& entry : std::filesystem::directory_iterator(directory_.path("out"))) {
    EXPECT_EQ(entry.path().extension(), ".yaml");  // nothing half done
  }
}

TEST_F(Program, AnOutputIsNoInput) {
  const std::string instance = directory_.file("i.yaml", kHeadOn);
  std::filesystem::create_symlink("i.yaml", directory_.path("link.yaml"));
  std::filesystem::create_hard_link(instance, directory_.path("twin.yaml"));
  const std::string remedy = "is an input too .*; choose another output file";
  for (const std::string name : {"i.yaml", "./i.yaml", "link.yaml", "twin.yaml"}) {
    expect_refused("solve -i i.yaml -o " + name, name + ": " + remedy);
    expect_refused("solve -i i.yaml --statistics " + name, name + ": " + remedy);
  }
  expect_refused("solve -i link.yaml -o i.yaml", "i.yaml: " + remedy);
  EXPECT_EQ(content_of(instance), kHeadOn);
  expect_refused("solve -i i.yaml -o p.yaml --statistics ./p.yaml",
                 "./p.yaml: is named for two outputs; .*");
  expect_refused("view i.yaml -o i.yaml", "i.yaml: " + remedy);
  ASSERT_EQ(run("view i.yaml -o view.html").exit_code, 0);
  expect_refused("view view.html", "view.html: " + remedy);
  ASSERT_EQ(run("bench i.yaml -q -o a.csv").exit_code, 0);
  expect_refused("bench merge a.csv -o a.csv", "a.csv: " + remedy);
  ASSERT_EQ(run("solve -i i.yaml -q -o p.yaml").exit_code, 0);
  expect_refused("toio export p.yaml --mat collection-ring -o p.yaml", "p.yaml: " + remedy);
}

//   Each would take gigabytes, or for ever; the line names what is too small.
TEST_F(Program, TinyNumbersAreRefused) {
  const auto instance = [this](const std::string& name, const std::string& key) {
    (void)directory_.file(name, key + "\n" + kHeadOn);
  };
  instance("i.yaml", "name: head on");
  instance("speed.yaml", "vehicle: {max_speed: 1e-300}");
  instance("dt.yaml", "dt: 1e-9");
  instance("steps.yaml", "vehicle: {max_speed: 0.001}");
  expect_refused("solve -i speed.yaml",
                 "speed.yaml: vehicle.max_speed: is 1e-300 m/s; give 0.001 to 1000000 m/s");
  expect_refused("solve -i dt.yaml", "dt.yaml: dt: is 1e-09 s; give 0.001 to 1000000 s");
  expect_refused("solve -i i.yaml --dt 1e-9", "solve: --dt: is \"1e-9\"; give a number from .*");
  expect_refused("solve -i steps.yaml --dt 0.001",
                 "steps.yaml: agents.0.: needs at least .* steps of dt = 0.001 s at max_speed = "
                 "0.001 m/s to its goal; .*");
}

TEST_F(Program, SpeedsTooFarApartAreRefused) {
  (void)directory_.file("i.yaml",
                        "agents:\n"
                        "  - {start: [5, 5, 0], goal: [9, 5, 0], vehicle: {max_speed: 100000}}\n"
                        "  - {start: [5, 15, 0], goal: [9, 15, 0], vehicle: {max_speed: 0.01}}\n"
                        "map: {dimensions: [50, 50]}\n");
  expect_refused("solve -i i.yaml -a escot-star",
                 "i.yaml: agents.1..vehicle.max_speed: is 0.01 m/s, where another agent has "
                 "100000 m/s; .*");
}

}  // namespace
}  // namespace mvtp
