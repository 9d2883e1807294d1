#include "tools/toio/plan/fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "planner/problem/input_error.hpp"
#include "tests/tools/program_fixture.hpp"

namespace mvtp {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;

constexpr double kPi = std::numbers::pi;

/// The car of CL-CBS, 3 x 2 m, on a straight drive of so many metres.
std::vector<PlannedRobot> straight_drive(double length) {
  const Vehicle vehicle = vehicle_preset("cl-cbs")->vehicle;
  return {{"agent0", vehicle, {0.0, 0.0, 0.0}, {{{0.0, 0.0, 0.0}, {length, 0.0}, {}}}}};
}

//   A body 3 x 2 m with the axle 1 m from its rear: tail first its width decides, 15.9 mm per metre
//   without margins and 20.9 mm with 5 mm beside; nose first its rear, 19.7 and 26.2 mm.
TEST(ToioFit, TheLeastScaleLetsThePlannedBodyCoverTheCube) {
  FitOptions options;
  const Fit fit = fit_to_mat(straight_drive(5.0), 5.0, find_mat("developer-all"), options);
  EXPECT_EQ(fit.facing, Facing::kTailFirst);
  EXPECT_NEAR(fit.least_scale, 0.0209, 1e-9);
  options.margins = {0.0, 0.0};
  EXPECT_NEAR(fit_to_mat(straight_drive(5.0), 5.0, find_mat("developer-all"), options).least_scale,
              0.0159, 1e-9);
}

//   At 20.9 mm per metre a drive of L metres covers 20.9 L mm, and the cube with 6.5 mm ahead and
//   behind 44.8 mm: 414 mm of the A3 mat hold 17.66 m, its 294 mm if turned 11.9 m.
TEST(ToioFit, WhatFitsIsDecidedByTheBodiesOnTheMat) {
  const Mat simple = find_mat("simple");
  EXPECT_THAT(fit_to_mat(straight_drive(17.6), 17.6, simple, {}).problem, IsEmpty());
  const Fit fit = fit_to_mat(straight_drive(17.7), 17.7, simple, {});
  EXPECT_THAT(fit.problem, MatchesRegex("at 20.9 mm per metre of the plan, the least for the true "
                                        "body, .* cover 415 x 42 mm; simple has 414 x 294 mm"));
  EXPECT_EQ(fit.smallest_mat, "developer-5");
}

TEST(ToioFit, APlanIsTurnedWhereOnlyThatFits) {
  const Mat tall{"tall", 0, 0, 100, 400, 0.0013625};
  const Fit fit = fit_to_mat(straight_drive(20.0), 20.0, tall, {});
  EXPECT_THAT(fit.problem, IsEmpty());
  EXPECT_EQ(fit.frame.quarter_turns, 1);
}

TEST(ToioFit, TheBodiesAreCentredOnTheMat) {
  const Fit fit = fit_to_mat(straight_drive(5.0), 5.0, find_mat("simple"), {});
  const Pose start = fit.frame.to_desk({0.0, 0.0, 0.0});
  const Pose goal = fit.frame.to_desk({5.0, 0.0, 0.0});
  const Vehicle body = body_of(Cube{}, fit.facing, TrackingMargins{});
  EXPECT_NEAR(start.x - body.rear, find_mat("simple").width() - goal.x - body.front, 1e-9);
  EXPECT_NEAR(start.y, find_mat("simple").height() / 2, 1e-9);
}

//   In an arc of 3 m the inner wheel is the slower one; at 22 mm/m it turns from 28.2 mm/s on.
TEST(ToioFit, TheInnerWheelSaysHowSlowIsTooSlow) {
  std::vector<PlannedRobot> robots = straight_drive(5.0);
  robots[0].legs[0].arc.curvature = 1.0 / 3.0;
  FitOptions options;
  options.scale = 0.022;
  options.speed = 0.028;
  const Fit slow = fit_to_mat(robots, 5.0, find_mat("collection-ring"), options);
  EXPECT_NEAR(slow.least_speed, 0.022512 / (1.0 - 13.3 / 66.0), 1e-9);
  EXPECT_THAT(slow.problem, HasSubstr("give --speed 29 or more"));
  options.speed = 0.029;
  EXPECT_THAT(fit_to_mat(robots, 5.0, find_mat("collection-ring"), options).problem, IsEmpty());
}

TEST(ToioFit, ABodyWithoutRearNeverCoversACube) {
  std::vector<PlannedRobot> robots = straight_drive(5.0);
  robots[0].vehicle.rear = -0.1;
  EXPECT_THAT(fit_to_mat(robots, 5.0, find_mat("simple"), {}).problem, HasSubstr("rear axle"));
}

TEST(ToioPath, LegsFollowTheArcsOfThePlan) {
  const Pose start{1.0, 2.0, 0.3};
  const Pose middle = drive(start, 2.0, 0.3);
  const Pose end = drive(middle, -1.5, -0.2);
  const std::vector<Leg> legs =
      legs_of(Trajectory({{start}, {middle}, {middle}, {end}, {end}}), "plan");
  ASSERT_EQ(legs.size(), 3u);  // the wait at the end is left out
  EXPECT_NEAR(legs[0].arc.length, 2.0, 1e-12);
  EXPECT_NEAR(legs[0].arc.curvature, 0.3, 1e-12);
  EXPECT_EQ(legs[1].arc.length, 0.0);
  EXPECT_NEAR(legs[2].arc.length, -1.5, 1e-12);
  EXPECT_NEAR(legs[2].at(1.0).x, end.x, 1e-12);
}

TEST(ToioPath, StepsThatNoCarDrivesAreRefused) {
  const auto refused = [](const Pose& to) {
    EXPECT_THROW((void)legs_of(Trajectory({{Pose{}}, {to}}), "plan"), InputError);
  };
  refused({0.0, 0.0, 0.5});
  refused({0.0, 1.0, 0.0});
  refused({1.0, 0.0, kPi / 2});
}

const std::vector<Leg> kThereAndBack = {{{0.1, 0.1, 0.0}, {0.05, 0.0}, {}},
                                        {{0.15, 0.1, 0.0}, {0.05, 0.0}, {}},
                                        {{0.2, 0.1, 0.0}, {0.0, 0.0}, {}},
                                        {{0.2, 0.1, 0.0}, {-0.05, 0.0}, {}}};

//   0.1 m forwards in two steps, a wait, 0.05 m back; 1 s per step. From rest to rest at 50 mm/s
//   with 200 mm/s^2 it takes 0.25 s longer than at full speed all the way.
TEST(ToioPath, RetimingKeepsTheAccelerationLimitAndStopsAtCusps) {
  const std::vector<MotionSample> samples =
      retime(kThereAndBack, {0.1, 0.1, 0.0}, 1.0, {.speedup = 1.0, .accel = 0.2, .cube = {}});
  EXPECT_NEAR(time_of(samples, 2.0), 2.25, 1e-3);
  EXPECT_NEAR(samples.back().time, 4.25, 1e-3);  // leaves when the plan says: the wait is shorter
  EXPECT_EQ(at_time(samples, 2.6).direction, 0);
  EXPECT_EQ(at_time(samples, 3.6).direction, -1);
  double speed = 0.0;
  for (double t = 0.01; t < samples.back().time; t += 0.01) {
    const double now = distance(at_time(samples, t - 0.01).pose, at_time(samples, t).pose) / 0.01;
    EXPECT_LE(std::abs(now - speed), 0.2 * 0.01 * 1.1) << t;
    EXPECT_LE(now, 0.05 + 1e-9);
    speed = now;
  }
}

TEST(ToioPath, TimesNeverFall) {
  const std::vector<MotionSample> samples =
      retime(kThereAndBack, {0.1, 0.1, 0.0}, 0.1, {.speedup = 0.5, .accel = 0.2, .cube = {}});
  for (std::size_t i = 1; i < samples.size(); ++i) {
    EXPECT_GE(samples[i].time, samples[i - 1].time);
    EXPECT_GE(samples[i].plan_time, samples[i - 1].plan_time);
  }
}

// What the plan drives too slowly for the wheels is driven faster, then waited for.
TEST(ToioPath, NoStepIsSlowerThanTheWheelsCan) {
  const std::vector<Leg> creep = {{{0.1, 0.1, 0.0}, {0.02, 0.0}, {}},
                                  {{0.12, 0.1, 0.0}, {-0.02, 0.0}, {}}};
  const std::vector<MotionSample> samples =
      retime(creep, {0.1, 0.1, 0.0}, 4.0, {.speedup = 1.0, .accel = 0.2, .cube = {}});
  EXPECT_LT(time_of(samples, 4.0), 1.1);
  EXPECT_GE(at_time(samples, 4.2).time, 4.0);
  EXPECT_EQ(at_time(samples, 3.9).direction, 0);
  EXPECT_EQ(at_time(samples, 4.1).direction, -1);
}

using ToioFitProgram = Program;

TEST_F(ToioFitProgram, FitSaysWhetherAndHow) {
  const std::string instance = std::string(MVTP_SCENARIOS) + "/toio/four.yaml";
  ASSERT_EQ(run("solve -i " + instance + " -o plan.yaml -q").exit_code, 0);
  const Outcome a3 = run("toio fit plan.yaml -i " + instance + " --mat simple");
  EXPECT_EQ(a3.exit_code, 0) << a3.err;
  EXPECT_THAT(a3.out, MatchesRegex("fits simple: 2[0-9].* mm per metre of the plan .*\n"
                                   "4 cubes, tail first.* at 50 mm/s .at least .*\n"
                                   "bodies pass .* mm apart at least; .*\n"));
  EXPECT_EQ(run("toio fit plan.yaml -i " + instance + " --mat collection-ring").exit_code, 0);
}

//   The circle of four robots on 50 x 50 m: 30 m apart, too large for a desk.
TEST_F(ToioFitProgram, APlanOnALargeMapIsRefusedWithNumbers) {
  const std::string instance = std::string(MVTP_SCENARIOS) + "/circle/circle4.yaml";
  ASSERT_EQ(run("solve -i " + instance + " -o plan.yaml -q").exit_code, 0);
  const Outcome a3 = run("toio fit plan.yaml -i " + instance + " --mat simple");
  EXPECT_EQ(a3.exit_code, 1);
  EXPECT_THAT(a3.out, MatchesRegex("does not fit: at 37.2 mm per metre of the plan.* cover 1... x "
                                   "1... mm; simple has 414 x 294 mm; smallest mat that fits: "
                                   "(none|developer-all)\n"));
  EXPECT_THAT(a3.err, IsEmpty());
}

TEST_F(ToioFitProgram, BadInputIsOneLine) {
  (void)directory_.file("plan.yaml", "schedule: {a: [{x: 0, y: 0, yaw: 0}]}\n");
  expect_refused("toio", ".*required.*");
  expect_refused("toio fit plan.yaml", "toio: --mat is required; see mvtp toio --help");
  expect_refused("toio fit plan.yaml --mat moon", "--mat: is \"moon\", neither .*");
  expect_refused("toio fit none --mat simple", "none: cannot be read: .*");
  expect_refused("toio fit plan.yaml --mat simple --speed nan", "toio: --speed: is \"nan\".*");
  expect_refused("toio fit plan.yaml --mat simple --vehicle tank", "--vehicle: is the unknown .*");
}

}  // namespace
}  // namespace mvtp
