#include "coordinator/junctions/instance_dump.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "coordinator/audit/footprint_motion.hpp"
#include "coordinator/simulation/simulation.hpp"
#include "planner/problem/check_instance.hpp"
#include "planner/problem/instance_file.hpp"
#include "planner/problem/validate.hpp"
#include "planner/solve.hpp"
#include "tests/coordinator/fake_traffic.hpp"
#include "tests/temporary_directory.hpp"

namespace mvtp {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// Three vehicles from each arm, one to each other arm.
std::vector<FakeTrip> trips() {
  const std::vector<std::string> arms = {"W", "S", "E", "N"};
  std::vector<FakeTrip> trips;
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      trips.push_back({arms[k] + std::to_string(i), 3.0 * double(i), arms[k] + "_in",
                       arms[(k + 1 + i) % 4] + "_out"});
    }
  }
  return trips;
}

/// The closed loop on the fake crossroads.
struct Crossing {
  Crossing() { simulation.add(coordinator); }
  void run_until(double end) {
    while (traffic.time() < end) simulation.step();
  }

  FakeTraffic traffic{make_crossroads(), trips()};
  DrivableArea area{traffic.network()};
  Coordinator coordinator{traffic, area, {}};
  Simulation simulation{traffic};
};

TEST(InstanceDump, ADecisionIsASoundInstanceThatCanBeSolved) {
  Crossing crossing;
  crossing.run_until(13.0);
  ASSERT_GE(crossing.coordinator.driven().size(), 6U);
  const Instance instance = instance_of(crossing.coordinator, crossing.area, 0.1);
  EXPECT_EQ(instance.agents.size(), crossing.coordinator.driven().size());
  EXPECT_THAT(check_instance(instance, "decision"), IsEmpty());

  const Plan plan = solve(instance, {}, Deadline::in(60));
  EXPECT_EQ(plan.statistics.status, "solved") << plan.statistics.reason;
  EXPECT_THAT(find_violations(instance, plan, CollisionRule::kContinuous), IsEmpty());
}

TEST(InstanceDump, StartsAreWhereTheVehiclesAre) {
  Crossing crossing;
  crossing.run_until(13.0);
  std::map<std::string, Pose> before;
  for (const VehicleState& v : crossing.traffic.vehicles()) before.emplace(v.id, v.pose);
  crossing.simulation.step();
  const Instance instance = instance_of(crossing.coordinator, crossing.area, 0.1);
  ASSERT_GE(instance.agents.size(), 2U);
  const Agent& first = instance.agents.front();
  const Point shift{before.at(first.name).x - first.start.x,
                    before.at(first.name).y - first.start.y};
  for (const Agent& agent : instance.agents) {
    const Pose& pose = before.at(agent.name);
    EXPECT_NEAR(agent.start.x + shift.x, pose.x, 0.05) << agent.name;
    EXPECT_NEAR(agent.start.y + shift.y, pose.y, 0.05) << agent.name;
    EXPECT_NEAR(agent.start.theta, pose.theta, 0.02) << agent.name;
    EXPECT_LE(agent.vehicle.max_speed, 13.9);
  }
}

//   At least what lies between the arms, and nothing of two arms over the whole map.
TEST(InstanceDump, WhatIsNotRoadIsSolid) {
  Crossing crossing;
  crossing.run_until(13.0);
  const Instance instance = instance_of(crossing.coordinator, crossing.area, 0.1);
  const double area = instance.map.width * instance.map.height;
  double solid = 0.0;
  for (const Polygon& p : instance.map.polygons) {
    solid += (p[1].x - p[0].x) * (p[2].y - p[1].y);
  }
  EXPECT_GT(solid, 0.8 * area);
  EXPECT_LT(solid, area - 6.4 * (instance.map.width + instance.map.height - 6.4));
}

TEST(InstanceDump, WritesEverySoManyDecisions) {
  const TemporaryDirectory directory;
  Crossing crossing;
  InstanceDump dump(crossing.coordinator, crossing.area,
                    {.folder = directory.path(""), .every = 4, .origin = "x.sumocfg, seed 7"});
  crossing.simulation.add([&](const Snapshot&) { dump.observe(); });
  crossing.run_until(40.0);
  const auto busy = std::ranges::count_if(crossing.coordinator.replans(),
                                          [](const Replan& r) { return r.vehicles >= 2; });
  ASSERT_GE(busy, 8);
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(directory.path(""))) {
    ++files;
    const Instance instance = read_instance(entry.path().string());
    EXPECT_GE(instance.agents.size(), 2U);
    EXPECT_EQ(instance.dt, 0.1);
    EXPECT_THAT(check_instance(instance, entry.path().filename().string()), IsEmpty());
    EXPECT_THAT(content_of(entry.path().string()), HasSubstr("x.sumocfg, seed 7, t = "));
  }
  EXPECT_NEAR(files, double(busy) / 4.0, 1.0);
}

}  // namespace
}  // namespace mvtp
