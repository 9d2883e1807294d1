#include "coordinator/audit.hpp"

#include <gtest/gtest.h>

#include "coordinator/free_flow.hpp"
#include "coordinator/referee.hpp"
#include "coordinator/report.hpp"
#include "coordinator/statistics.hpp"
#include "tests/coordinator/fake_traffic.hpp"

namespace mvtp {
namespace {

const Vehicle kCar = {.front = 3.6, .rear = 0.9, .width = 1.8};

TEST(Clearance, IsTheGapBetweenTwoCarsInOneLane) {
  EXPECT_NEAR(clearance({0, 0, 0}, kCar, {10, 0, 0}, kCar), 10.0 - 4.5, 1e-12);
  EXPECT_NEAR(clearance({0, 0, 0}, kCar, {0, 3, 0}, kCar), 3.0 - 1.8, 1e-12);
}

TEST(Clearance, OfTwoCornersIsTheirDistance) {
  EXPECT_NEAR(clearance({0, 0, 0}, kCar, {7.5, 5.8, 0}, kCar), 5.0, 1e-12);  // 3 and 4 m apart
}

TEST(Clearance, IsNegativeByTheDepthOfAnOverlap) {
  EXPECT_NEAR(clearance({0, 0, 0}, kCar, {4.4, 0, 0}, kCar), -0.1, 1e-12);
  EXPECT_NEAR(clearance({0, 0, 0}, kCar, {0, 1.6, 0}, kCar), -0.2, 1e-12);
}

TEST(Clearance, DoesNotDependOnOrderOrFrame) {
  const Pose a{1, 2, 0.3};
  const Pose b{6, 4, 2.0};
  const Pose shift{-100, 50, 1.1};
  const double gap = clearance(a, kCar, b, kCar);
  EXPECT_NEAR(clearance(b, kCar, a, kCar), gap, 1e-9);
  EXPECT_NEAR(clearance(compose(shift, a), kCar, compose(shift, b), kCar), gap, 1e-9);
}

/// Two cars on the road of the fake crossroads, seen by an audit.
class AuditTest : public testing::Test {
 protected:
  AuditTest() : network(make_crossroads()), area(network), audit(area, 0.1) {
    type.body = kCar;
    type.body.max_accel = 2.6;
    type.body.max_decel = 4.5;
  }

  void see(double time, const VehicleState& a, bool ours, const VehicleState& b) {
    const std::vector<Sighting> sightings = {{&a, &type, ours}, {&b, &type, false}};
    audit.observe(time, sightings);
  }

  RoadNetwork network;
  DrivableArea area;
  Audit audit;
  VehicleType type;
};

TEST_F(AuditTest, CountsAPairOnceAndItsStepsEach) {
  const VehicleState a{.id = "a", .pose = {-100, -1.6, 0}};
  const VehicleState b{.id = "b", .pose = {-97, -1.6, 0}};
  see(0.1, a, true, b);
  see(0.2, a, true, b);
  EXPECT_EQ(audit.figures().overlap_pairs, 1);
  EXPECT_EQ(audit.figures().overlap_pairs_coordinated, 1);
  EXPECT_EQ(audit.figures().overlap_vehicle_steps, 4);
  EXPECT_LT(audit.figures().min_clearance, 0.0);
}

TEST_F(AuditTest, TwoCarsOfTheTrafficAreNotOurOverlap) {
  see(0.1, {.id = "a", .pose = {-100, -1.6, 0}}, false, {.id = "b", .pose = {-97, -1.6, 0}});
  EXPECT_EQ(audit.figures().overlap_pairs, 1);
  EXPECT_EQ(audit.figures().overlap_pairs_coordinated, 0);
}

TEST_F(AuditTest, SeesABodyThatLeavesTheRoad) {
  const VehicleState far{.id = "b", .pose = {100, -1.6, 0}};
  see(0.1, {.id = "a", .pose = {-100, -1.6, 0}}, true, far);
  EXPECT_EQ(audit.figures().off_road_steps, 0);
  see(0.2, {.id = "a", .pose = {-100, -2.4, 0}}, true,
      far);  // its side is at -3.3, the road's -3.2
  EXPECT_EQ(audit.figures().off_road_steps, 1);
}

TEST_F(AuditTest, SeesAJumpAtTheTakeover) {
  const VehicleState far{.id = "b", .pose = {100, -1.6, 0}};
  see(0.1, {.id = "a", .pose = {-100, -1.6, 0}, .speed = 10}, false, far);
  see(0.2, {.id = "a", .pose = {-98.7, -1.6, 0}, .speed = 10}, true, far);  // 0.3 m too far
  EXPECT_NEAR(audit.figures().max_jump, 0.3, 1e-9);
}

TEST_F(AuditTest, MeasuresAccelerationFromThePosesAlone) {
  const VehicleState far{.id = "b", .pose = {100, -1.6, 0}};
  double x = -100.0;
  for (int k = 0; k < 4; ++k) {  // 1.0, 1.0, 1.04 m in 0.1 s: 4 m/s^2
    see(0.1 * k, {.id = "a", .pose = {x, -1.6, 0}, .speed = 10}, true, far);
    x += k == 2 ? 1.04 : 1.0;
  }
  EXPECT_NEAR(audit.figures().max_accel, 4.0, 1e-6);
  EXPECT_EQ(audit.figures().accel_violations, 1);
}

TEST_F(AuditTest, CountsHardBrakingOnlyAfterAHandBack) {
  const VehicleState far{.id = "b", .pose = {100, -1.6, 0}};
  see(0.1, {.id = "a", .pose = {-100, -1.6, 0}, .speed = 10}, true, far);
  see(0.2, {.id = "a", .pose = {-99, -1.6, 0}, .speed = 9.2}, false, far);  // 8 m/s^2
  EXPECT_EQ(audit.figures().hard_brakings_after_handback, 1);
  see(4.0, {.id = "a", .pose = {-98, -1.6, 0}, .speed = 8.0}, false, far);  // 12, but later
  EXPECT_EQ(audit.figures().hard_brakings_after_handback, 1);
}

// Two paths that cross at s = 50; both vehicles get there at the same time.
TEST(Referee, SeesTwoVehiclesThatWouldMeet) {
  PathLibrary library(Margins{});
  library.add(GuidePath(std::vector<Point>{{-50, 0}, {50, 0}}), kCar);
  library.add(GuidePath(std::vector<Point>{{0, -50}, {0, 50}}), kCar);
  RoadScene scene{.library = &library};
  JointPlan plan;
  for (int i = 0; i < 2; ++i) {
    scene.vehicles.push_back({.key = i, .path = i, .now = {0, 10}});
    PathTrajectory t;
    for (int k = 0; k < 90; ++k) t.states.push_back({double(k), 10.0});
    plan.entries.push_back({i, std::make_shared<PathTrajectory>(t)});
  }
  const auto contact = find_planned_contact(scene, plan, 1);
  ASSERT_TRUE(contact);
  EXPECT_NEAR(double(contact->step), 46.0, 2.0);

  PathTrajectory later;  // two seconds behind
  for (int k = 0; k < 110; ++k) later.states.push_back({std::max(0.0, k - 20.0), 10.0});
  plan.entries[1].trajectory = std::make_shared<PathTrajectory>(later);
  EXPECT_FALSE(find_planned_contact(scene, plan, 1));
}

TEST(FreeFlow, AddsTheTimesOfAllLanes) {
  const RoadNetwork network = make_crossroads(200.0);
  // 182.8 m before the junction, an arc of 5.6 m radius at 6.5 m/s, 150 m behind it.
  const double arc = network.lanes.at(":C_WS_0").length;
  const std::vector<std::string> route = {"W_in", "S_out"};
  EXPECT_NEAR(FreeFlow(network).duration(route, "W_in_0", 10.0, 150.0, 1.0, 50.0),
              (192.8 - 10.0) / 13.89 + arc / 6.5 + 150.0 / 13.89, 1e-9);
  EXPECT_NEAR(FreeFlow(network).duration(route, "W_in_0", 10.0, 150.0, 1.0, 5.0),
              (192.8 - 10.0 + arc + 150.0) / 5.0, 1e-9);
}

TEST(Report, CountsTheDelayOfThoseWhoNeverArrive) {
  const VehicleRecord done{
      .intended_departure = 10, .departure = 12, .arrival = 70, .free_flow = 50};
  const VehicleRecord stuck{.intended_departure = 10, .departure = 12, .free_flow = 50};
  EXPECT_DOUBLE_EQ(delay_of(done, 100.0), 10.0);
  EXPECT_DOUBLE_EQ(delay_of(stuck, 100.0), 40.0);
  EXPECT_DOUBLE_EQ(delay_of(stuck, 30.0), 0.0);
}

TEST(Report, QuantilesInterpolate) {
  EXPECT_DOUBLE_EQ(quantile({}, 0.5), 0.0);
  EXPECT_DOUBLE_EQ(quantile({4, 1, 3, 2}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile({4, 1, 3, 2}, 1.0), 4.0);
}

TEST(Report, SucceedsOnlyIfAllArriveUntouched) {
  RunReport report;
  report.vehicles = {{.arrival = 5.0}};
  EXPECT_TRUE(succeeded(report));
  report.audit.overlap_pairs_coordinated = 1;
  EXPECT_FALSE(succeeded(report));
  report.audit.overlap_pairs_coordinated = 0;
  report.vehicles.push_back({});
  EXPECT_FALSE(succeeded(report));
}

}  // namespace
}  // namespace mvtp
