#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <set>

#include "planner/problem/check_instance.hpp"
#include "planner/problem/input_error.hpp"
#include "planner/problem/instance_file.hpp"
#include "planner/problem/referee_geometry.hpp"
#include "planner/solve.hpp"
#include "tests/tools/program_fixture.hpp"
#include "tools/generate/open_lot.hpp"
#include "tools/generate/parking_instance.hpp"
#include "tools/generate/random_instance.hpp"
#include "tools/generate/suite.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

int instances(const std::vector<Cell>& cells) {
  return std::accumulate(cells.begin(), cells.end(), 0,
                         [](int sum, const Cell& cell) { return sum + cell.instances; });
}

std::vector<int> robots(const std::vector<Cell>& cells) {
  std::vector<int> numbers;
  for (const Cell& cell : cells) numbers.push_back(cell.robots);
  return numbers;
}

// ---- which cells

TEST(Suites, HaveTheSizesOfThePaper) {
  EXPECT_THAT(robots(cells_of(Suite::kTypical)), ElementsAre(2, 4, 8));
  EXPECT_THAT(robots(cells_of(Suite::kSparse)), ElementsAre(2, 4, 6, 8, 10));
  EXPECT_EQ(instances(cells_of(Suite::kSparse)), 300);
  EXPECT_EQ(cells_of(Suite::kDense).size(), 29U);
  EXPECT_EQ(instances(cells_of(Suite::kDense)), 1740);
  const std::vector<int> dense = robots(cells_of(Suite::kDense));
  EXPECT_EQ(std::ranges::min(dense), 5);
  EXPECT_EQ(std::ranges::max(dense), 120);
}

TEST(Suites, AChoiceKeepsTheCellsThatMatchInAllItNames) {
  const std::vector<Cell> cells =
      choose_cells(Suite::kDense, {.sides = {50}, .obstacles = {20}, .robots = {10, 20, 60}});
  EXPECT_THAT(robots(cells), ElementsAre(10, 20));
  EXPECT_EQ(choose_cells(Suite::kDense, {.sides = {}, .instances = 3}).back().instances, 3);
}

TEST(Suites, OnlyCrowdMakesCellsThatItDoesNotList) {
  EXPECT_THROW((void)choose_cells(Suite::kDense, {.sides = {70}, .robots = {7}}), InputError);
  EXPECT_THAT(choose_cells(Suite::kCrowd, {.sides = {70}, .robots = {7}}),
              ElementsAre(Cell{Suite::kCrowd, Layout::kRandom, 70, 0, 7, 10}));
}

TEST(Suites, TheFileNameSaysTheCell) {
  EXPECT_EQ(file_name(cells_of(Suite::kDense).back(), 7), "dense_map100x100_obst40_a110_ex07.yaml");
  EXPECT_EQ(file_name(cells_of(Suite::kTypical).front(), 0),
            "typical_map50x50_circle_a002_ex00.yaml");
}

// ---- what instances are like

/// The least distance of rear axles, and of bodies, among the starts and among the goals.
std::pair<double, double> least_distances(const Instance& instance) {
  double axles = 1e9;
  double bodies = 1e9;
  for (const auto pose : {&Agent::start, &Agent::goal}) {
    for (const Agent& a : instance.agents) {
      for (const Agent& b : instance.agents) {
        if (&a == &b) continue;
        axles = std::min(axles, distance(a.*pose, b.*pose));
        bodies = std::min(bodies, referee::separation(referee::footprint(a.vehicle, a.*pose),
                                                      referee::footprint(b.vehicle, b.*pose)));
      }
    }
  }
  return {axles, bodies};
}

class GeneratedInstances : public testing::TestWithParam<Cell> {};

TEST_P(GeneratedInstances, ObeyTheRulesOfPlacement) {
  for (const char* vehicle : {"escot", "cl-cbs"}) {
    const GeneratedInstance made = generate_instance(GetParam(), {.vehicle = vehicle}, 0);
    Instance instance = made.instance;
    ASSERT_EQ(int(instance.agents.size()), GetParam().robots);
    ASSERT_EQ(int(instance.map.circles.size()), GetParam().obstacles);
    EXPECT_EQ(instance.map.bounds, Bounds::kAxle);
    EXPECT_EQ(instance.dt, vehicle_preset(vehicle)->dt);

    instance.map.bounds = Bounds::kFootprint;
    EXPECT_THAT(check_instance(instance, "it"), IsEmpty());
    const auto [axles, bodies] = least_distances(instance);
    EXPECT_GE(bodies, 0.5 - 1e-9);
    const bool is_roomy = made.description.find("sqrt(20)") != std::string::npos;
    EXPECT_TRUE(is_roomy || GetParam().robots == 100) << "sqrt(20) m fits in this cell";
    if (is_roomy) {
      EXPECT_GE(axles, std::sqrt(20.0));
    }
    for (Circle circle : instance.map.circles) {
      EXPECT_EQ(circle.radius, 0.8);
      for (const Agent& agent : instance.agents) {
        for (const Pose& pose : {agent.start, agent.goal}) {
          EXPECT_GE(referee::separation(referee::footprint(agent.vehicle, pose), circle),
                    0.5 - 1e-9);
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cells, GeneratedInstances,
                         testing::Values(Cell{Suite::kSparse, Layout::kRandom, 50, 20, 10, 1},
                                         Cell{Suite::kDense, Layout::kRandom, 50, 0, 60, 1},
                                         Cell{Suite::kCrowd, Layout::kRandom, 50, 0, 100, 1},
                                         Cell{Suite::kCrowd, Layout::kRandom, 50, 40, 60, 1}));

//   Without the check several of these have a robot that cannot get out of its corner.
TEST(GeneratedInstance, LetsEachRobotFindASingleAgentPath) {
  const Cell crammed{Suite::kCrowd, Layout::kRandom, 16, 25, 2, 10};
  for (int index = 0; index < crammed.instances; ++index) {
    const GeneratedInstance made = generate_instance(crammed, {}, index);
    EXPECT_THAT(robots_without_single_agent_path(made.instance), IsEmpty()) << index;
  }
}

//   agent0 wants to get into a closed room, agent1 past it.
TEST(RobotsWithoutSingleAgentPath, AreThoseWithAWalledGoal) {
  Instance instance;
  instance.map = {.width = 30, .height = 30};
  const auto wall = [](double x0, double y0, double x1, double y1) {
    return Polygon{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  };
  instance.map.polygons = {wall(14, 9, 22, 10), wall(14, 20, 22, 21), wall(14, 9, 15, 21),
                           wall(21, 9, 22, 21)};
  instance.agents = {{"agent0", {}, {5, 15, 0}, {18, 15, 0}},
                     {"agent1", {}, {5, 5, 0}, {25, 15, 1}}};
  EXPECT_THAT(robots_without_single_agent_path(instance), ElementsAre(0U));
}

TEST(GeneratedInstance, OnACircleEachGoalIsStraightAhead) {
  for (const Cell& cell : cells_of(Suite::kTypical)) {
    for (const Agent& agent : generate_instance(cell, {}, 0).instance.agents) {
      const Pose ahead = relative(agent.start, agent.goal);
      EXPECT_NEAR(ahead.x, 30.0, 2e-3);
      EXPECT_NEAR(ahead.y, 0.0, 3e-3);
      EXPECT_NEAR(ahead.theta, 0.0, 1e-9);
    }
  }
}

TEST(GeneratedInstance, DependsOnSeedAndNumberOnly) {
  const Cell cell{Suite::kSparse, Layout::kRandom, 50, 20, 4, 60};
  const auto start = [&](std::uint64_t seed, int index) {
    return generate_instance(cell, {.seed = seed}, index).instance.agents[0].start;
  };
  EXPECT_EQ(start(1, 2), start(1, 2));
  EXPECT_NE(start(1, 2), start(1, 3));
  EXPECT_NE(start(1, 2), start(2, 2));
  EXPECT_NE(start(1, 2), start(1 + (std::uint64_t(1) << 32U), 2));
}

/// A known answer: the standard specifies the generator to the bit, so that these digits hold on
/// every machine, and results stay comparable for ever.
TEST(GeneratedInstance, IsTheSameOnEveryMachine) {
  const Cell cell{Suite::kSparse, Layout::kRandom, 50, 20, 2, 60};
  const Instance instance = generate_instance(cell, {}, 0).instance;
  EXPECT_EQ(instance.agents[1].goal, (Pose{26.581, 29.392, 2.6608}));
}

TEST(GeneratedInstance, SaysWhenSoManyDoNotFit) {
  try {
    (void)generate_instance({Suite::kCrowd, Layout::kRandom, 20, 3, 100, 1}, {}, 0);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("100 robots among 3 obstacles on 20 x 20 m: no instance"));
    EXPECT_THAT(error.what(), HasSubstr("; give fewer robots or obstacles, or a larger map"));
  }
}

// ---- cars that come and go

/// How far the body is out of the slot that it is nearest to, turned either way [m].
double out_of_slot(const Agent& agent, const Pose& pose, double west) {
  const Pose body = compose(pose, {(agent.vehicle.front - agent.vehicle.rear) / 2, 0.0, 0.0});
  double least = 1e9;
  for (const ParkingSlot& slot : open_lot().slots) {
    const Pose seen = relative(slot.middle, {body.x - west, body.y, body.theta});
    if (std::abs(std::sin(seen.theta)) > 1e-3) continue;
    least =
        std::min(least, std::max(std::abs(seen.x) + agent.vehicle.length() / 2 - slot.length / 2,
                                 std::abs(seen.y) + agent.vehicle.width / 2 - slot.width / 2));
  }
  return least;
}

TEST(GeneratedParking, CarsComeFromTheRoadAndLeaveForIt) {
  for (const ParkingCell& cell : {ParkingCell{24, 24, 1}, ParkingCell{0, 7, 1},
                                  ParkingCell{9, 0, 1}, ParkingCell{29, 29, 1}}) {
    const Instance instance = generate_parking(cell, 5, 0).instance;
    EXPECT_THAT(check_instance(instance, "it"), IsEmpty());
    EXPECT_EQ(instance.map.bounds, Bounds::kFootprint);
    const double west = instance.map.width - 51.0;
    ASSERT_EQ(int(instance.agents.size()), cell.in + cell.out);
    for (const Agent& agent : instance.agents) {
      const bool comes = agent.name.starts_with("in");
      const Pose& in_slot = comes ? agent.goal : agent.start;
      const Pose& on_road = comes ? agent.start : agent.goal;
      EXPECT_LE(out_of_slot(agent, in_slot, west), -0.0) << agent.name;
      EXPECT_LT(on_road.x, west);
      EXPECT_EQ(std::abs(on_road.y - 20.0) > 13.5, true);
      EXPECT_EQ(on_road.theta, comes ? 0.0 : 3.1416);
      EXPECT_EQ(agent.vehicle.max_speed, 2.78);
    }
    // 58 slots, four islands, and the ground between the roads.
    EXPECT_EQ(int(instance.map.polygons.size()), 58 - cell.in - cell.out + 5);
    EXPECT_GE(least_distances(instance).second, 0.3);
  }
}

TEST(GeneratedParking, HasAllSizesAndBothWaysRound) {
  std::set<double> lengths;
  int forward = 0;
  int all = 0;
  for (int index = 0; index < 4; ++index) {
    for (const Agent& agent : generate_parking({}, 0, index).instance.agents) {
      lengths.insert(std::round(10 * agent.vehicle.length()) / 10);
      const Pose& in_slot = agent.name.starts_with("in") ? agent.goal : agent.start;
      forward += std::abs(in_slot.theta) < 1.0 ? 1 : 0;
      ++all;
    }
  }
  EXPECT_THAT(lengths, ElementsAre(4.3, 4.5, 4.8, 5.2, 5.9));
  EXPECT_GT(forward, all / 3);
  EXPECT_LT(forward, 2 * all / 3);
}

TEST(GeneratedParking, EachFindsASingleAgentPath) {
  const Instance instance = generate_parking({6, 6, 1}, 1, 0).instance;
  EXPECT_THAT(robots_without_single_agent_path(instance), IsEmpty());
}

//   Cars queue two abreast, in and out by one road each: nobody gets anywhere but in turn.
TEST_F(Program, TwentyFourCarsComeAndTwentyFourLeaveAtOnce) {
  ASSERT_EQ(run("generate parking --count 1 --seed 11 -o lots -q").exit_code, 0);
  const std::string instance = " -i lots/parking_in24_out24_ex00.yaml ";
  const Outcome solved =
      run("solve --algorithm escot-star --gap 9 --time-limit 300 -o plan.yaml -q" + instance);
  EXPECT_EQ(solved.exit_code, 0) << solved.err;
  const Outcome referee = run("validate -s plan.yaml" + instance);
  EXPECT_EQ(referee.exit_code, 0) << referee.out;
}

TEST(GeneratedParking, IsTheSameOnEveryMachine) {
  const Instance instance = generate_parking({}, 0, 0).instance;
  EXPECT_EQ(instance.agents[1].goal, (Pose{129.06, 29.75, 0.0}));
  EXPECT_NE(generate_parking({}, 1, 0).instance.agents[1].goal, instance.agents[1].goal);
  EXPECT_NE(generate_parking({}, 0, 1).instance.agents[1].goal, instance.agents[1].goal);
}

// ---- the command

TEST_F(Program, GenerateWritesTheSameBytesForTheSameSeed) {
  ASSERT_EQ(run("generate sparse --count 2 -o a -q").exit_code, 0);
  const Outcome second = run("generate sparse --count 3 --robots 4,10 -o deep/b -q");
  EXPECT_EQ(second.exit_code, 0);
  EXPECT_THAT(second.out + second.err, IsEmpty());
  EXPECT_EQ(shell("ls a | wc -l").out, "10\n");
  EXPECT_EQ(shell("ls deep/b | wc -l").out, "6\n");
  EXPECT_EQ(
      shell("cd deep/b && for f in *ex00* *ex01*; do cmp $f ../../a/$f || exit 1; done").exit_code,
      0);
  ASSERT_EQ(run("generate sparse --count 2 -o c -q --seed 1").exit_code, 0);
  EXPECT_EQ(shell("for f in $(ls a); do cmp -s a/$f c/$f && exit 1; done; true").exit_code, 0);
}

TEST_F(Program, GenerateParkingWritesTheSameBytesForTheSameSeed) {
  ASSERT_EQ(run("generate parking --count 2 --in 3 --out 2 -o a -q").exit_code, 0);
  ASSERT_EQ(run("generate parking --count 3 --in 3 --out 2 -o b -q").exit_code, 0);
  EXPECT_EQ(shell("ls b").out,
            "parking_in03_out02_ex00.yaml\nparking_in03_out02_ex01.yaml\n"
            "parking_in03_out02_ex02.yaml\n");
  EXPECT_EQ(shell("for f in $(ls a); do cmp a/$f b/$f || exit 1; done").exit_code, 0);
  const Instance instance = read_instance(directory_.path("a/parking_in03_out02_ex01.yaml"));
  EXPECT_EQ(instance.dt, 0.8);
  EXPECT_EQ(instance.map.bounds, Bounds::kFootprint);
}

TEST_F(Program, GeneratedFilesNameTheVehicle) {
  ASSERT_EQ(run("generate typical -o a -q --vehicle cl-cbs --bounds footprint").exit_code, 0);
  const std::string file = directory_.path("a/typical_map50x50_circle_a004_ex00.yaml");
  EXPECT_THAT(content_of(file), HasSubstr("vehicle: {preset: cl-cbs}\nagents:"));
  const Instance instance = read_instance(file);
  EXPECT_EQ(instance.agents[0].vehicle, vehicle_preset("cl-cbs")->vehicle);
  EXPECT_EQ(instance.dt, vehicle_preset("cl-cbs")->dt);
  EXPECT_EQ(instance.map.bounds, Bounds::kFootprint);
  const Instance other = read_instance(file, {.vehicle_preset = "escot"});
  EXPECT_EQ(other.dt, 1.0);
  EXPECT_THAT(run("solve -i a/typical_map50x50_circle_a004_ex00.yaml").exit_code, 0);
}

TEST_F(Program, GenerateRefusesWhatItCannotDo) {
  (void)directory_.file("file", "x");
  expect_refused("generate", "generate: suite is required; .*");
  expect_refused("generate fog -o a", "generate: suite: is \"fog\"; choose .*");
  expect_refused("generate dense", "generate: --output-dir is required; .*");
  expect_refused("generate dense -o ''", "--output-dir: is empty; give a folder");
  expect_refused("generate dense -o file", "file: cannot make this folder .*; choose another .*");
  expect_refused("generate dense -o file/a", "file/a: cannot make this folder .*");
  expect_refused("generate dense -o /proc/a", "/proc/a: cannot make this folder .*");
  expect_refused("generate dense -o a --robots 7", "dense: has no cell .* robots");
  expect_refused("generate dense -o a --robots 5,x",
                 "generate: --robots: is \"x\"; give a whole number from 1 to 10000; .*");
  expect_refused("generate dense -o a --count 0", "generate: --count: is \"0\"; give a whole .*");
  expect_refused("generate dense -o a --seed nan", "generate: --seed: is \"nan\"; give a whole .*");
  expect_refused("generate dense -o a --vehicle tank",
                 "generate: --vehicle: is \"tank\"; choose escot.cl-cbs; .*");
  expect_refused("generate parking -o a --robots 5",
                 "--robots: is not for parking; give --in and --out");
  expect_refused("generate dense -o a --in 5", "--in: is for parking only; leave it out");
  expect_refused("generate parking -o a --in 30 --out 29",
                 "--in 30 and --out 29: the lot has 58 slots; give at most 58 together");
  expect_refused("generate parking -o a --in 0 --out 0",
                 "--in 0 and --out 0: nobody comes or goes; give at least one");
  expect_refused("generate parking -o a --in -1", "generate: --in: is \"-1\"; give a whole .*");
  expect_refused("generate crowd -o b --size 20 --robots 500 -q", "500 robots .* larger map");
  EXPECT_FALSE(std::filesystem::exists(directory_.path("a")));
}

}  // namespace
}  // namespace mvtp
