// What each world's public header says that a caller does, in that order, by this header alone.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "planner/lot.hpp"
#include "planner/problem/check_instance.hpp"
#include "planner/problem/validate.hpp"
#include "planner/road.hpp"
#include "planner/solve.hpp"

namespace mvtp {
namespace {

using testing::IsEmpty;

const Vehicle kCity{.front = 3.6,
                    .rear = 0.9,
                    .width = 1.8,
                    .wheelbase = 2.7,
                    .min_turning_radius = 4.0,
                    .max_speed = 14.0,
                    .max_accel = 2.6,
                    .max_decel = 4.5};

RoadVehicle vehicle_on(const PathLibrary& library, std::int64_t key, int path) {
  RoadVehicle vehicle{.key = key, .path = path, .now = {60.0, 10.0}};
  const std::vector<double> limits(library.path(path).samples(), 14.0);
  vehicle.envelope = std::make_shared<SpeedEnvelope>(limits, library.body(path).max_decel);
  vehicle.s_handback = 160.0;
  vehicle.s_end = 180.0;
  return vehicle;
}

TEST(PublicHeaders, OfRoadsLeadTwoVehiclesOverACrossing) {
  PathLibrary library(Margins{});
  const std::vector<int> paths = {
      library.add(ReferencePath(std::vector<Point>{{-100, 0}, {100, 0}}), kCity),
      library.add(ReferencePath(std::vector<Point>{{0, -100}, {0, 100}}), kCity)};
  RoadScene scene{.library = &library};
  for (const int path : paths) scene.vehicles.push_back(vehicle_on(library, path, path));
  library.build_tables(paths);

  JointPlan plan;
  std::vector<std::int64_t> newcomers = {0, 1};
  for (int decision = 0; decision < 60; ++decision) {
    const RoadDecision decided = decide_on_road(scene, plan, newcomers, {});
    ASSERT_EQ(decided.stepped, 0);
    plan = decided.plan;
    newcomers.clear();
    scene.step += scene.grid.steps_per_decision;
    for (RoadVehicle& v : scene.vehicles) {
      const InertialState then = plan.find(v.key)->at(scene.step);
      if (then.s < SpeedProfile::kDeparted) v.now = then;
    }
    const auto body = [&](std::size_t i) {
      const RoadVehicle& v = scene.vehicles[i];
      return footprint(kCity, library.path(v.path).at(v.now.s));
    };
    ASSERT_GT(separation(body(0), body(1)), 0.0) << "in decision " << decision;
    std::erase_if(plan.entries, [&](const auto& e) { return e.profile->end() <= scene.step; });
    std::erase_if(scene.vehicles, [&](const RoadVehicle& v) { return !plan.find(v.key); });
    if (scene.vehicles.size() < 2) return;  // one of them has left
  }
  FAIL() << "both are still on the road";
}

TEST(PublicHeaders, OfLotsParkACar) {
  ParkingLot lot;
  lot.ground = {{0, 0}, {40, 0}, {40, 30}, {0, 30}};
  LotPlanner planner(lot, {});
  LotMotion motion;
  const Pose goal{30, 20, 0};
  planner.set_standing({{.pose = {20, 10, 0}, .body = kCity}});
  const LotRequest request{.key = 1, .body = kCity, .pose = {5, 5, 0}, .goals = {goal}};
  ASSERT_TRUE(planner.admit(motion, request, {}));
  for (int decision = 0; decision < 200 && !motion.cars().front().at_end(); ++decision) {
    (void)planner.decide(motion, {});
    const std::vector<double> stopping_points = {1e9};
    for (int step = 0; step < 5; ++step) motion.step(0.1, stopping_points);
  }
  EXPECT_TRUE(motion.cars().front().at_end());
  EXPECT_LT(distance(motion.cars().front().pose(), goal), 0.01);
  motion.remove(1);
  EXPECT_THAT(motion.cars(), IsEmpty());
}

TEST(PublicHeaders, OfMapsGiveAPlanThatTheRefereeAccepts) {
  Instance instance;
  instance.map.width = 40;
  instance.map.height = 20;
  instance.agents = {
      {.name = "left", .vehicle = {}, .start = {5, 10, 0}, .goal = {35, 10, 0}},
      {.name = "low", .vehicle = {}, .start = {5, 4, 0}, .goal = {35, 4, 0}},
  };
  ASSERT_THAT(check_instance(instance, "two robots"), IsEmpty());
  EXPECT_THAT(robots_without_single_agent_path(instance), IsEmpty());
  const Plan plan = solve(instance, {}, Deadline::never());
  EXPECT_EQ(plan.statistics.status, to_string(Status::kSolved));
  EXPECT_THAT(find_violations(instance, plan, CollisionRule::kContinuous), IsEmpty());
}

}  // namespace
}  // namespace mvtp
