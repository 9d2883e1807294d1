#include "coordinator/audit/audit.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <tuple>

#include "coordinator/measures/statistics.hpp"
#include "coordinator/report/free_flow.hpp"
#include "coordinator/report/report.hpp"
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
    const std::vector<Observation> observations = {{&a, &type, ours}, {&b, &type, false}};
    audit.observe(time, observations);
  }

  /// `a` alone, coordinated, at one pose after the other.
  void drive_alone(std::span<const Pose> poses) {
    double time = 0.0;
    for (const Pose& pose : poses) {
      const VehicleState a{.id = "a", .pose = pose};
      const std::vector<Observation> observations = {{&a, &type, true}};
      audit.observe(time += 0.1, observations);
    }
  }

  RoadNetwork network;
  DrivableArea area;
  Audit audit;
  VehicleType type;
};

/// `steps` steps of `length` [m] along an arc.
void append_arc(std::vector<Pose>& poses, int steps, double length, double curvature) {
  for (int k = 0; k < steps; ++k) poses.push_back(drive(poses.back(), length, curvature));
}

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

TEST_F(AuditTest, AnEventSaysWhatItIsAndWhoDidIt) {
  const VehicleState a{.id = "a", .pose = {-100, -2.4, 0}};
  const VehicleState b{.id = "b", .pose = {-97, -1.6, 0}};
  see(0.1, a, true, b);
  ASSERT_EQ(audit.events().size(), 2U);
  const AuditEvent& overlap = audit.events()[0];
  EXPECT_EQ(overlap.kind, AuditEventKind::kOverlap);
  EXPECT_EQ(overlap.who, (std::vector<std::string>{"a", "b"}));
  EXPECT_NEAR(overlap.depth, 1.0, 1e-9);  // as wide as they are, beside each other by 0.8 m
  EXPECT_EQ(audit.events()[1].kind, AuditEventKind::kOffRoad);
  EXPECT_EQ(audit.events()[1].who, std::vector<std::string>{"a"});
}

// Two that touch under human drivers are told again when one of them comes under control.
TEST_F(AuditTest, AnOverlapIsToldOnceAndOnceMoreIfItBecomesOurs) {
  const VehicleState a{.id = "a", .pose = {-97, -1.6, 0}};
  const VehicleState b{.id = "b", .pose = {-100, -1.6, 0}};
  for (const double time : {0.1, 0.2}) see(time, b, false, a);
  ASSERT_EQ(audit.events().size(), 1U);
  EXPECT_EQ(audit.events()[0].what, "overlap of a (human-driven) and b (human-driven)");
  EXPECT_FALSE(audit.events()[0].coordinated);
  for (const double time : {0.3, 0.4}) see(time, b, true, a);
  ASSERT_EQ(audit.events().size(), 2U);
  EXPECT_EQ(audit.events()[1].what, "overlap of a (human-driven) and b");
  EXPECT_TRUE(audit.events()[1].coordinated);
  EXPECT_NEAR(audit.events()[1].time, 0.3, 0.1);
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

//   a sidewalk, y from 3.4 to 5.4 m
//   a bicycle lane, y from 1.7 to 3.3 m
//   a lane of cars, y from -1.6 to 1.6 m
TEST(AuditOnLanesOfOneClass, JudgesVehiclesByTheLanesThatAreOpenToThem) {
  RoadNetwork network;
  for (const auto& [id, y, width, allowed] : {std::tuple{"e_0", 4.4, 2.0, "pedestrian"},
                                              {"e_1", 2.5, 1.6, "bicycle"},
                                              {"e_2", 0.0, 3.2, ""}}) {
    Lane lane{.id = id, .edge = "e", .index = int(network.lanes.size()), .width = width};
    lane.shape = {{0.0, y}, {100.0, y}};
    lane.road = lane.drivable = *allowed == '\0';
    if (!lane.road) lane.allowed = {allowed};
    network.edges["e"].push_back(id);
    network.lanes.emplace(id, lane);
  }
  const VehicleType car{.id = "car", .body = {.front = 3.6, .rear = 0.9, .width = 1.2}};
  const VehicleType bike{
      .id = "bike", .body = {.front = 1.4, .rear = 0.2, .width = 0.65}, .vehicle_class = "bicycle"};
  const DrivableArea road(network);
  const auto off_road = [&](const VehicleType& type, double y) {
    Audit audit(road, 0.1, network, {});
    const VehicleState v{.id = "v", .type = type.id, .pose = {20.0, y, 0.0}};
    const std::vector<Observation> observations = {{&v, &type, false}};
    audit.observe(0.1, observations);
    return audit.figures().off_road_steps;
  };
  EXPECT_EQ(off_road(bike, 0.0), 0);
  EXPECT_EQ(off_road(bike, 2.5), 0);
  EXPECT_EQ(off_road(bike, 1.7), 0) << "between the two";
  EXPECT_EQ(off_road(bike, 4.4), 1) << "on the sidewalk";
  EXPECT_EQ(off_road(car, 0.0), 0);
  EXPECT_EQ(off_road(car, 2.5), 1);
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

// At 13.9 m/s, 0.5 m apart at both steps: the one behind clips the other's tail corner.
TEST_F(AuditTest, SeesAnOverlapBetweenTwoSteps) {
  const double half = (4.5 + 1.8) / 2.0;
  const double to_middle = (3.6 - 0.9) / 2.0;
  const auto crossing = [&](double t, double time) {
    const double ahead = half - 0.885 + 1.39 * t;  // of the middle of b
    const double below = half + 0.505 - 1.39 * t;
    const VehicleState a{.id = "a", .pose = {ahead - to_middle, 0, 0}, .speed = 13.9};
    const VehicleState b{
        .id = "b", .pose = {0, -below - to_middle, std::numbers::pi / 2}, .speed = 13.9};
    see(time, a, true, b);
  };
  crossing(0.0, 0.1);
  EXPECT_NEAR(audit.figures().min_clearance, 0.505, 1e-9);
  crossing(1.0, 0.2);
  EXPECT_EQ(audit.figures().overlap_pairs_coordinated, 1);
  EXPECT_EQ(audit.figures().overlap_vehicle_steps, 2);
  EXPECT_NEAR(audit.figures().min_clearance, -0.19, 0.002);
  ASSERT_FALSE(audit.events().empty());
  EXPECT_NEAR(audit.events().front().time, 0.15, 0.001);
}

TEST_F(AuditTest, ALaneChangeWithinOneStepDoesNotSweepOverTheNeighbour) {
  const VehicleState beside{.id = "b", .pose = {-98, -1.6, 0}, .speed = 10};
  see(0.1, {.id = "a", .pose = {-100, -4.8, 0}, .speed = 10}, false, beside);
  see(0.2, {.id = "a", .pose = {-99, 1.6, 0}, .speed = 10}, false, beside);
  EXPECT_EQ(audit.figures().overlap_pairs, 0);
}

TEST_F(AuditTest, TheSameLeapOfACoordinatedVehicleIs) {
  const VehicleState beside{.id = "b", .pose = {-98, -1.6, 0}, .speed = 10};
  see(0.1, {.id = "a", .pose = {-100, -4.8, 0}, .speed = 10}, true, beside);
  see(0.2, {.id = "a", .pose = {-99, 1.6, 0}, .speed = 10}, true, beside);
  EXPECT_EQ(audit.figures().overlap_pairs_coordinated, 1);
}

TEST_F(AuditTest, ATeleportDoesNotSweepOverOthers) {
  const VehicleState between{.id = "b", .pose = {-50, -1.6, 0}};
  see(0.1, {.id = "a", .pose = {-100, -1.6, 0}, .speed = 10}, false, between);
  see(0.2, {.id = "a", .pose = {0, -1.6, 0}, .speed = 10}, false, between);
  EXPECT_EQ(audit.figures().overlap_pairs, 0);
}

TEST_F(AuditTest, SeesAPersonRunOverBetweenTwoSteps) {
  const auto walk = [&](double time, double y, double x) {
    const VehicleState a{.id = "a", .pose = {x, -1.6, 0}, .speed = 60};
    const std::vector<Observation> observations = {{&a, &type, true}};
    const std::vector<Pedestrian> people = {{.id = "p", .position = {-90, y}, .speed = 1.4}};
    audit.observe(time, observations, people);
  };
  walk(0.1, -1.67, -95.0);  // 1.1 m before the bumper
  EXPECT_EQ(audit.figures().people_touched, 0);
  walk(0.2, -1.53, -88.0);  // 0.8 m behind the tail
  EXPECT_EQ(audit.figures().people_touched, 1);
  EXPECT_LT(audit.figures().min_person_clearance, -0.3);
}

TEST_F(AuditTest, ABendTakenAtConstantSpeedIsNoAcceleration) {
  std::vector<Pose> poses = {{-20, -1.6, 0}};
  append_arc(poses, 10, 0.6, 0.0);
  poses.push_back(drive(drive(poses.back(), 0.3, 0.0), 0.3, 0.15));
  append_arc(poses, 14, 0.6, 0.15);
  poses.push_back(drive(drive(poses.back(), 0.2, 0.15), 0.4, -0.15));
  append_arc(poses, 10, 0.6, -0.15);
  drive_alone(poses);
  EXPECT_LT(audit.figures().max_accel, 0.01);
  EXPECT_LT(audit.figures().max_decel, 0.01);
  EXPECT_NEAR(audit.figures().max_lateral_accel, 36.0 * 0.15, 0.01);
  EXPECT_LT(audit.figures().max_jump, 1e-9);
}

TEST_F(AuditTest, ReversingWithoutComingToRestBreaksTheLimits) {
  std::vector<Pose> poses = {{-100, -1.6, 0}};
  append_arc(poses, 3, 0.1, 0.0);
  append_arc(poses, 3, -0.1, 0.0);  // from 1 to -1 m/s in 0.1 s
  drive_alone(poses);
  EXPECT_NEAR(audit.figures().max_decel, 20.0, 1e-6);
  EXPECT_EQ(audit.figures().accel_violations, 1);
}

TEST_F(AuditTest, ReversingAfterBrakingIsWithinTheLimits) {
  std::vector<Pose> poses = {{-100, -1.6, 0}};
  for (const double speed : {0.3, 0.1, -0.1, -0.3}) append_arc(poses, 1, 0.1 * speed, 0.0);
  drive_alone(poses);
  EXPECT_EQ(audit.figures().accel_violations, 0);
}

TEST_F(AuditTest, ASlowHeadingThatTremblesIsNoLateralAcceleration) {
  std::vector<Pose> poses = {{-100, -1.6, 0}};
  for (int k = 0; k < 20; ++k) {
    poses.push_back({poses.back().x + 0.1, -1.6, k == 10 ? 0.1 : 0.0});  // 1 m/s, once 6 degrees
  }
  drive_alone(poses);
  EXPECT_LT(audit.figures().max_lateral_accel, 0.15);
}

TEST_F(AuditTest, AHeadingThatJumpsAtSpeedIs) {
  std::vector<Pose> poses = {{-100, -1.6, 0}};
  for (int k = 0; k < 20; ++k) poses.push_back({poses.back().x + 1.0, -1.6, k < 10 ? 0.0 : 0.3});
  drive_alone(poses);
  EXPECT_GT(audit.figures().max_lateral_accel, 25.0);
}

TEST_F(AuditTest, SeesAStepSidewaysOfACoordinatedVehicle) {
  drive_alone(std::vector<Pose>{{-100, -1.6, 0}, {-99, -1.6, 0}, {-98, -1.3, 0}});
  EXPECT_NEAR(audit.figures().max_jump, 0.3, 1e-9);
}

TEST_F(AuditTest, SeesABodyThatSwingsAroundItsBumperAtTheHandBack) {
  const VehicleState far{.id = "b", .pose = {100, -1.6, 0}};
  type.body.min_turning_radius = 6.0;
  const Pose turned = compose({-95.4, -1.6, 0.5}, {-3.6, 0, 0});  // the bumper goes straight on
  see(0.1, {.id = "a", .pose = {-100, -1.6, 0}, .speed = 10}, true, far);
  see(0.2, {.id = "a", .pose = turned, .speed = 10}, false, far);
  EXPECT_GT(audit.figures().max_jump, 1.0);
}

TEST(StepMotion, IsTheArcOfACarThatSteers) {
  const Pose start{3, -2, 2.5};
  for (const double curvature : {0.0, 1e-7, 0.2, -0.4}) {
    for (const double length : {1.4, -0.8}) {
      const StepMotion motion(start, drive(start, length, curvature));
      for (const double t : {0.0, 0.25, 0.7, 1.0}) {
        const Pose expected = drive(start, t * length, curvature);
        EXPECT_NEAR(distance(motion.at(t), expected), 0.0, 1e-9);
        EXPECT_NEAR(motion.at(t).theta, expected.theta, 1e-9);
      }
    }
  }
}

TEST(StepMotion, MovesItsPointsAsItSays) {
  const StepMotion motion({1, 2, 0.4}, {2.2, 1.7, 1.0});
  const Pose soon = motion.at(1e-6);
  const Pose front = compose(soon, {3, 0, 0});
  const Pose before = compose({1, 2, 0.4}, {3, 0, 0});
  EXPECT_NEAR((front.x - before.x) / 1e-6, motion.velocity(3.0).x, 1e-4);
  EXPECT_NEAR((front.y - before.y) / 1e-6, motion.velocity(3.0).y, 1e-4);
}

// Every step at 1/1000 of it, for pairs that meet, pass closely, turn and reverse.
TEST(NearestMoment, IsThatOfTheWholeStepSampledFinely) {
  std::mt19937_64 random(7);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * double(random() >> 11) * 0x1p-53;
  };
  const Vehicle truck = {.front = 9.0, .rear = 3.0, .width = 2.5};
  int overlaps_between = 0;
  for (int pair = 0; pair < 5000; ++pair) {
    const Vehicle& other = pair % 3 == 0 ? truck : kCar;
    const Pose a{0, 0, uniform(-3.1, 3.1)};
    const Pose b{uniform(-8, 8), uniform(-8, 8), uniform(-3.1, 3.1)};
    const StepMotion ma(
        a, compose(drive(a, uniform(-0.5, 3), uniform(-0.3, 0.3)), {0, uniform(-0.1, 0.1), 0}));
    const StepMotion mb(b, drive(b, uniform(-0.5, 3), uniform(-0.3, 0.3)));
    double least = 1e300;
    for (int k = 0; k <= 1000; ++k) {
      least = std::min(least, clearance(ma.at(0.001 * k), kCar, mb.at(0.001 * k), other));
    }
    const NearestMoment found = nearest_moment(ma, kCar, mb, other, 0.0, 3.0);
    const double at_it = clearance(ma.at(found.t), kCar, mb.at(found.t), other);
    EXPECT_DOUBLE_EQ(found.gap, at_it);
    if (least < 2.99) {
      EXPECT_LE(found.gap, least + std::max(1e-4, 0.0101 * std::abs(least)));
    } else {
      EXPECT_GE(found.gap, 2.98);
    }
    const double at_steps =
        std::min(clearance(a, kCar, b, other), clearance(ma.at(1.0), kCar, mb.at(1.0), other));
    overlaps_between += at_steps > 0.0 && found.gap < -Audit::kTolerance ? 1 : 0;
  }
  EXPECT_GT(overlaps_between, 10);  // the pairs are such that it matters
}

TEST(NearestMoment, OfAPersonIsThatOfTheWholeStepSampledFinely) {
  std::mt19937_64 random(11);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * double(random() >> 11) * 0x1p-53;
  };
  for (int pair = 0; pair < 2000; ++pair) {
    const Pose a{0, 0, uniform(-3.1, 3.1)};
    const StepMotion motion(a, drive(a, uniform(-0.5, 3), uniform(-0.3, 0.3)));
    const Point before{uniform(-6, 6), uniform(-6, 6)};
    const Pedestrian person{
        .position = {before.x + uniform(-0.3, 0.3), before.y + uniform(-0.3, 0.3)}};
    double least = 1e300;
    for (int k = 0; k <= 1000; ++k) {
      const double t = 0.001 * k;
      const Point p{before.x + t * (person.position.x - before.x),
                    before.y + t * (person.position.y - before.y)};
      const Pose seen = relative(motion.at(t), {p.x, p.y, 0});
      const double ahead = std::max(seen.x - kCar.front, -kCar.rear - seen.x);
      const double aside = std::abs(seen.y) - kCar.width / 2.0;
      const double outside = std::hypot(std::max(ahead, 0.0), std::max(aside, 0.0));
      least = std::min(least, (outside > 0.0 ? outside : std::max(ahead, aside)) - person.radius);
    }
    const NearestMoment found = nearest_moment(motion, kCar, before, person, 0.0, 100.0);
    EXPECT_NEAR(found.gap, least, std::max(1e-3, 0.0101 * std::abs(least)));
  }
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
