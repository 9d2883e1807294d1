#include "planner/problem/plan_file.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <thread>

#include "planner/problem/input_error.hpp"
#include "planner/problem/metrics.hpp"
#include "planner/problem/text_file.hpp"
#include "tests/temporary_directory.hpp"

namespace mvtp {
namespace {

using testing::HasSubstr;

/// A plan as CL-CBS writes it.
const std::string kPeers = R"(statistics:
  cost: 12.7
  makespan: 4.236
  flowtime: 8.472
  runtime: 0.0038
schedule:
  agent0:
    - x: 16.36
      y: 5.32
      yaw: 2.22
      t: 0
    - x: 15.0788
      y: 7.00662
      yaw: 2.22
      t: 1
  agent1:
    - x: 30
      y: 5
      yaw: 0
      t: 0
)";

Plan example_plan() {
  Plan plan;
  plan.statistics.status = "solved";
  plan.statistics.algorithm = "escot";
  plan.statistics.pbcr = "paper";
  plan.statistics.runtime = 0.1;
  plan.statistics.lower_bound = 1.5;
  plan.statistics.solo_makespan = 1.75;
  plan.statistics.first_solution = 0.0625;
  plan.statistics.seed = 18446744073709551615u;
  plan.statistics.dt = 0.1;
  plan.statistics.version = "0.1.0";
  plan.names = {"agent0", "no", "odd: \"name\" # 1"};
  Trajectory first(Pose{1.0 / 3.0, -0.0, 1e-7});
  first.push_back({{1e16, 123456.789, -3.14159}, -1.0, 0.31});
  first.push_back({{1e16, 123456.789, -3.14159}, 0.0, 0.0});
  plan.trajectories = {first, Trajectory(Pose{1, 2, 3}), Trajectory(Pose{4, 5, 0.1 + 0.2})};
  fill_in_durations(plan);
  return plan;
}

class PlanFile : public testing::Test {
 protected:
  Plan read(const std::string& text, const PlanReadOptions& options = {},
            const std::string& name = "plan.yaml") {
    return read_plan(directory_.file(name, text), options);
  }
  std::string error(const std::string& text) {
    try {
      (void)read(text);
    } catch (const InputError& e) {
      const std::string what = e.what();
      return what.substr(what.find("plan.yaml"));
    }
    return "no error";
  }
  TemporaryDirectory directory_;
};

TEST_F(PlanFile, ReadsBackWhatItWritesBitByBit) {
  const Plan plan = example_plan();
  for (const YawSense yaw : {YawSense::kCounterClockwise, YawSense::kClockwise}) {
    const std::string path = directory_.path("plan.yaml");
    write_plan(plan, path, yaw);
    const Plan again = read_plan(path);  // a clockwise file says so itself
    EXPECT_EQ(again.names, plan.names);
    EXPECT_EQ(again.trajectories, plan.trajectories);
    EXPECT_EQ(again.statistics.status, "solved");
    EXPECT_EQ(again.statistics.algorithm, "escot");
    EXPECT_EQ(again.statistics.pbcr, "paper");
    EXPECT_EQ(again.statistics.seed, plan.statistics.seed);
    EXPECT_EQ(again.statistics.dt, 0.1);
    EXPECT_EQ(again.statistics.runtime, 0.1);
    EXPECT_EQ(again.statistics.makespan_steps, 1u);
    EXPECT_EQ(again.statistics.makespan, plan.statistics.makespan);
    EXPECT_EQ(again.statistics.solo_makespan, 1.75);
    EXPECT_EQ(again.statistics.first_solution, 0.0625);
    EXPECT_EQ(again.statistics.version, "0.1.0");
  }
}

TEST_F(PlanFile, WritesTheLinesOfTheFormat) {
  const std::string path = directory_.path("plan.yaml");
  Plan plan = example_plan();
  plan.names.resize(1);
  plan.trajectories = {Trajectory(Pose{1, 2, 0.5})};
  plan.trajectories[0].push_back({{2, 2, 0.5}, 1.0, 0.0});
  write_plan(plan, path);
  EXPECT_THAT(content_of(path),
              HasSubstr("schedule:\n"
                        "  agent0:\n"
                        "    - {x: 1.0, y: 2.0, yaw: 0.5, t: 0}\n"
                        "    - {x: 2.0, y: 2.0, yaw: 0.5, t: 1, v: 1.0, phi: 0.0}\n"));
  EXPECT_THAT(content_of(path), HasSubstr("statistics:\n  status: solved\n  algorithm: escot\n"));
}

TEST_F(PlanFile, RecordsTheVehicleThatAllShare) {
  Plan plan = example_plan();
  plan.vehicles.assign(plan.names.size(), vehicle_preset("cl-cbs")->vehicle);
  write_plan(plan, directory_.path("plan.yaml"));
  EXPECT_THAT(content_of(directory_.path("plan.yaml")),
              HasSubstr("\nvehicle: {preset: cl-cbs}\nschedule:\n"));
  EXPECT_EQ(read_plan(directory_.path("plan.yaml")).vehicles, plan.vehicles);
}

TEST_F(PlanFile, RecordsVehiclesOfSeveralKindsBitByBit) {
  Plan plan = example_plan();
  plan.vehicles.assign(plan.names.size(), Vehicle{.width = 0.1 + 0.2, .max_accel = 1.5});
  plan.vehicles[1] = vehicle_preset("escot")->vehicle;
  write_plan(plan, directory_.path("plan.yaml"));
  EXPECT_EQ(read_plan(directory_.path("plan.yaml")).vehicles, plan.vehicles);
}

TEST_F(PlanFile, PlansOfPeersAndOldOnesRecordNoVehicle) {
  Instance instance{.agents = {{"agent0", {}, {}, {}}}, .map = {}};
  const Plan plan = read(kPeers);
  EXPECT_TRUE(plan.vehicles.empty());
  EXPECT_FALSE(take_vehicles(plan, instance));
  EXPECT_EQ(instance.agents[0].vehicle, Vehicle{});
}

TEST_F(PlanFile, AgentsTakeTheVehicleOfTheirName) {
  Plan plan = example_plan();
  plan.vehicles.assign(plan.names.size(), Vehicle{});
  plan.vehicles[1].width = 1.5;
  Instance instance{.agents = {{plan.names[1], {}, {}, {}}, {"other", {}, {}, {}}}, .map = {}};
  EXPECT_TRUE(take_vehicles(plan, instance));
  EXPECT_EQ(instance.agents[0].vehicle.width, 1.5);
  EXPECT_EQ(instance.agents[1].vehicle, Vehicle{});
  EXPECT_FALSE(take_vehicles(plan, instance));
}

TEST_F(PlanFile, NumbersAreFloatsForEveryYamlReader) {
  const std::string path = directory_.path("plan.yaml");
  write_plan(example_plan(), path);
  EXPECT_THAT(content_of(path), HasSubstr("yaw: 1.0e-07"));  // "1e-07" is a string for YAML 1.1
  EXPECT_THAT(content_of(path), HasSubstr("x: 1.0e+16"));
  EXPECT_THAT(content_of(path), HasSubstr("\"no\":"));  // no is false for YAML 1.1
}

TEST_F(PlanFile, ReadsThePlansOfPeers) {
  const Plan plan = read(kPeers, {.dt = 2.118});
  EXPECT_THAT(plan.names, testing::ElementsAre("agent0", "agent1"));
  EXPECT_EQ(plan.statistics.dt, 2.118);
  EXPECT_EQ(plan.statistics.cost, 12.7);
  ASSERT_EQ(plan.trajectories[0].makespan(), 1u);
  EXPECT_EQ(plan.trajectories[0].at(1).pose, (Pose{15.0788, 7.00662, 2.22}));
  EXPECT_TRUE(std::isnan(plan.trajectories[0].at(1).v));
  EXPECT_TRUE(std::isnan(plan.trajectories[0].at(1).phi));
  EXPECT_EQ(read(kPeers, {.yaw = YawSense::kClockwise}).trajectories[0].at(0).pose.theta, -2.22);
}

TEST_F(PlanFile, ReadsGuoAndYusPaths) {
  const Plan plan =
      read(R"({"cost": 3, "paths": [[[1, 2, 0], [3, 2, 0]], [[9, 9, 1]]]})", {}, "plan.json");
  EXPECT_THAT(plan.names, testing::ElementsAre("agent0", "agent1"));
  EXPECT_EQ(plan.trajectories[0].at(1).pose, (Pose{3, 2, 0}));
  EXPECT_TRUE(std::isnan(plan.trajectories[0].at(1).v));
}

struct BadPlan {
  const char* name;
  const char* text;
  const char* message;
};
class BadPlans : public PlanFile, public testing::WithParamInterface<BadPlan> {};
TEST_P(BadPlans, AreToldByPlaceValueAndRemedy) {
  EXPECT_EQ(error(GetParam().text), std::string("plan.yaml: ") + GetParam().message);
}
INSTANTIATE_TEST_SUITE_P(
    Cases, BadPlans,
    testing::Values(
        BadPlan{"NoSchedule", "statistics: {cost: 1}\nnote: schedule",
                "schedule: is missing; add it"},
        BadPlan{"Instance", "agents: []",
                "is not a plan file (it has no key schedule or paths); "
                "give the right file"},
        BadPlan{"EmptyTrajectory", "schedule: {a: []}",
                "schedule.a: is a list of 0; give a list like [{x: 1.0, y: 2.0, yaw: 0.0, t: 0}]"},
        BadPlan{"NaN", "schedule: {a: [{x: .nan, y: 0, yaw: 0, t: 0}]}",
                "schedule.a[0].x: is \".nan\"; give a finite number [m]"},
        BadPlan{"NoYaw", "schedule: {a: [{x: 1, y: 0, t: 0}]}",
                "schedule.a[0].yaw: is missing; add it"},
        BadPlan{"SkippedStep",
                "schedule: {a: [{x: 1, y: 0, yaw: 0, t: 0}, {x: 1, y: 0, yaw: 0, t: 2}]}",
                "schedule.a[1].t: is 2 where step 1 should stand; list every step once, from 0 on"},
        BadPlan{"SameAgentTwice", "schedule: {a: [], a: []}",
                "a map has the key \"a\" twice; remove one"},
        BadPlan{"BadControl", "schedule: {a: [{x: 1, y: 0, yaw: 0, t: 0, v: fast}]}",
                "schedule.a[0].v: is \"fast\"; give a finite number [m/s]"},
        BadPlan{"BadStep", "statistics: {dt: 0}\nschedule: {}",
                "statistics.dt: is 0 s; give a number > 0"},
        BadPlan{"List", "- schedule", "is a list of 1; give a map like {schedule: ...}"}),
    [](const auto& test) { return test.param.name; });

// ---- output

std::string write_error(const std::string& path) {
  for (const bool only_check : {true, false}) {
    try {
      only_check ? check_writable(path) : write_plan(example_plan(), path);
    } catch (const InputError& e) {
      if (!only_check) return e.what();
      continue;
    }
    return only_check ? "check_writable found nothing" : "no error";
  }
  return "";
}

TEST_F(PlanFile, UnwritableOutputIsFoundBeforeAndWhenWriting) {
  EXPECT_THAT(write_error(directory_.path("none/plan.yaml")),
              HasSubstr("none/plan.yaml: cannot be written: No such file or directory"));
  EXPECT_THAT(write_error(directory_.path("")), HasSubstr("it is a directory"));
  EXPECT_THAT(write_error(directory_.file("a", "") + "/plan.yaml"), HasSubstr("Not a directory"));
  EXPECT_THAT(write_error(""), HasSubstr("empty name"));
}

TEST_F(PlanFile, ALookBeforehandLeavesNoTrace) {
  check_writable(directory_.path("plan.yaml"));
  EXPECT_EQ(directory_.size(), 0);
  const std::string old = directory_.file("old.yaml", "old");
  check_writable(old);
  EXPECT_EQ(content_of(old), "old");
  EXPECT_EQ(directory_.size(), 1);
}

TEST_F(PlanFile, WritingReplacesTheWholeFileAndNothingElse) {
  const std::string path = directory_.file("plan.yaml", std::string(100'000, 'x'));
  std::filesystem::permissions(path, std::filesystem::perms(0640));
  std::filesystem::create_symlink("plan.yaml", directory_.path("link.yaml"));
  write_plan(example_plan(), directory_.path("link.yaml"));
  EXPECT_TRUE(std::filesystem::is_symlink(directory_.path("link.yaml")));
  EXPECT_THAT(content_of(path), testing::StartsWith("statistics:"));
  EXPECT_EQ(std::filesystem::status(path).permissions(), std::filesystem::perms(0640));
  EXPECT_EQ(directory_.size(), 2);
}

TEST_F(PlanFile, NewFilesHaveTheUsualRights) {
  const mode_t mask = ::umask(0027);
  write_plan(example_plan(), directory_.path("plan.yaml"));
  ::umask(mask);
  EXPECT_EQ(std::filesystem::status(directory_.path("plan.yaml")).permissions(),
            std::filesystem::perms(0640));
}

//   The mask of rights belongs to the process: files that other threads make meanwhile keep theirs.
TEST_F(PlanFile, WritingLeavesTheRightsOfOtherFilesAlone) {
  const mode_t mask = ::umask(0077);
  std::atomic<bool> done = false;
  int open_to_others = 0;
  std::thread other([&] {
    while (!done) {
      const std::string path = directory_.path("other");
      const int fd = ::open(path.c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0666);
      struct stat made {};
      ::fstat(fd, &made);
      if ((made.st_mode & 0777U) != 0600U) ++open_to_others;
      ::close(fd);
      ::unlink(path.c_str());
    }
  });
  for (int n = 0; n < 500; ++n) write_text_file(directory_.path("plan.yaml"), "x");
  done = true;
  other.join();
  ::umask(mask);
  EXPECT_EQ(open_to_others, 0);
}

TEST_F(PlanFile, ADanglingLinkStaysALink) {
  std::filesystem::create_directory(directory_.path("results"));
  std::filesystem::create_symlink("second", directory_.path("first"));
  std::filesystem::create_symlink("results/plan.yaml", directory_.path("second"));
  check_writable(directory_.path("first"));
  write_plan(example_plan(), directory_.path("first"));
  EXPECT_TRUE(std::filesystem::is_symlink(directory_.path("first")));
  EXPECT_TRUE(std::filesystem::is_symlink(directory_.path("second")));
  EXPECT_THAT(content_of(directory_.path("results/plan.yaml")), testing::StartsWith("statistics:"));
}

TEST_F(PlanFile, APipeWithoutANameIsWrittenToDirectly) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const std::string path = "/proc/self/fd/" + std::to_string(ends[1]);  // as behind /dev/stdout
  check_writable(path);
  write_text_file(path, "plan");
  std::array<char, 8> read{};
  EXPECT_EQ(::read(ends[0], read.data(), read.size()), 4);
  EXPECT_STREQ(read.data(), "plan");
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST_F(PlanFile, ALinkToAFolderIsNoOutput) {
  std::filesystem::create_directory(directory_.path("results"));
  std::filesystem::create_symlink("results", directory_.path("link"));
  EXPECT_THAT(write_error(directory_.path("link")), HasSubstr("it is a directory"));
}

TEST_F(PlanFile, LinksInACircleAreNoOutput) {
  std::filesystem::create_symlink("b", directory_.path("a"));
  std::filesystem::create_symlink("a", directory_.path("b"));
  EXPECT_THAT(write_error(directory_.path("a")), HasSubstr("symbolic links"));
}

TEST_F(PlanFile, DevicesAreWrittenDirectly) {
  EXPECT_NO_THROW(write_plan(example_plan(), "/dev/null"));
  EXPECT_THAT(write_error("/dev/full"),
              testing::AnyOf(HasSubstr("No space left"), HasSubstr("found nothing")));
  EXPECT_THROW(write_plan(example_plan(), "/dev/full"), InputError);
}

// ---- metrics

TEST(Metrics, WaitsAtTheEndDoNotCount) {
  Plan plan;
  plan.statistics.dt = 0.5;
  plan.names = {"a", "b"};
  Trajectory a(Pose{0, 0, 0});
  for (const double x : {1.0, 1.0, 2.0, 2.0, 2.0}) a.push_back({{x, 0, 0}});
  plan.trajectories = {a, Trajectory(Pose{9, 9, 0})};
  EXPECT_EQ(arrival_step(a), 3u);
  EXPECT_EQ(makespan_steps(plan), 3u);
  EXPECT_EQ(flowtime_steps(plan), 3u);
  fill_in_durations(plan);
  EXPECT_EQ(plan.statistics.makespan, 1.5);
  EXPECT_EQ(plan.statistics.cost, 1.5);
}

}  // namespace
}  // namespace mvtp
