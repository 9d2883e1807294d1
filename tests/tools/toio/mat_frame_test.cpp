#include "tools/toio/cube/mat_frame.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "planner/problem/input_error.hpp"
#include "tests/temporary_directory.hpp"

namespace mvtp {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(ToioMat, TheMatsAreThoseOfTheSpecification) {
  const Mat ring = find_mat("collection-ring");
  EXPECT_EQ(ring.min_x, 45);
  EXPECT_EQ(ring.max_y, 455);
  EXPECT_NEAR(ring.width(), 0.559, 0.001);
  const Mat all = find_mat("developer-all");
  EXPECT_NEAR(all.width(), 1.260, 0.003);
  EXPECT_NEAR(all.height(), 1.188, 0.003);
}

//   The sheets of developer mats tile the large one: 1-4 make its first column, 12 ends it.
TEST(ToioMat, TheDeveloperSheetsTileTheWhole) {
  const Mat all = find_mat("developer-all");
  EXPECT_EQ(find_mat("developer-1").min_x, all.min_x);
  EXPECT_EQ(find_mat("developer-1").min_y, all.min_y);
  EXPECT_EQ(find_mat("developer-4").min_x, all.min_x);
  EXPECT_EQ(find_mat("developer-2").min_y, find_mat("developer-1").max_y + 1);
  EXPECT_EQ(find_mat("developer-5").min_x, find_mat("developer-1").max_x + 1);
  EXPECT_EQ(find_mat("developer-12").max_x, all.max_x);
  EXPECT_EQ(find_mat("developer-12").max_y, all.max_y);
}

TEST(ToioMat, AFileDescribesAnyOther) {
  const TemporaryDirectory directory;
  const Mat mat = find_mat(
      directory.file("mat.yaml", "{name: floor, range: [10, 20, 110, 220], mm_per_dot: 1.4}"));
  EXPECT_EQ(mat, (Mat{"floor", 10, 20, 110, 220, 0.0014}));
}

TEST(ToioMat, BadMatsAreNamed) {
  const TemporaryDirectory directory;
  const auto problem = [&](const std::string& text) -> std::string {
    try {
      (void)find_mat(directory.file("mat.yaml", text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  };
  using testing::HasSubstr;
  EXPECT_THAT(problem("{range: [10, 20, 10, 220]}"), HasSubstr("range: is empty"));
  EXPECT_THAT(problem("{range: [10, 20, 1e9, 220]}"), HasSubstr("range[2]: is 1000000000"));
  EXPECT_THAT(problem("{range: [10.5, 20, 30, 220]}"), HasSubstr("range[0]: is 10.5"));
  EXPECT_THAT(problem("{range: [1, 2, 30, 40], mm_per_dot: 734}"), HasSubstr("mm_per_dot: is 734"));
  EXPECT_THAT(problem("{range: [1, 2, 30, 40], scale: 1}"), HasSubstr("scale"));
  EXPECT_THROW((void)find_mat("atlantis"), InputError);
}

DeskFrame desk_frame(Facing facing) {
  return {.mat = find_mat("collection-ring"), .cube = {}, .facing = facing};
}

//   Lower left corner of the mat, heading up: on the mat, y is largest there and up is 270 degrees.
TEST(ToioMatFrame, YPointsDownAndAnglesRunClockwise) {
  DeskFrame frame = desk_frame(Facing::kNoseFirst);
  frame.cube.center_to_axle = 0.0;
  const MatPose corner = frame.to_mat({0.0, 0.0, kPi / 2});
  EXPECT_NEAR(corner.x, 45, 1e-9);
  EXPECT_NEAR(corner.y, 455, 1e-9);
  EXPECT_NEAR(corner.degrees, 270, 1e-9);
  const MatPose up = frame.to_mat({0.0, 0.0013625, kPi / 2});
  EXPECT_NEAR(up.y, 454, 1e-9);
}

//   The axle is 3.8 mm ahead of the centre that the cube reports, as the cube faces.
TEST(ToioMatFrame, TheReportedCentreIsBehindTheAxle) {
  DeskFrame frame = desk_frame(Facing::kNoseFirst);
  const double shift = 0.0038 / 0.0013625;
  EXPECT_NEAR(frame.to_mat({0.1, 0.1, 0.0}).x, 45 + 0.1 / 0.0013625 - shift, 1e-9);
  frame.facing = Facing::kTailFirst;
  const MatPose tail_first = frame.to_mat({0.1, 0.1, 0.0});
  EXPECT_NEAR(tail_first.x, 45 + 0.1 / 0.0013625 + shift, 1e-9);
  EXPECT_NEAR(tail_first.degrees, 180, 1e-9);
}

//   The sensor is behind and to the left.   y down: left of a cube that faces +x is a smaller y.
TEST(ToioMatFrame, TheSensorIsRearLeft) {
  const DeskFrame frame = desk_frame(Facing::kNoseFirst);
  const MatPose sensor = frame.sensor({0.1, 0.1, 0.0});
  EXPECT_NEAR(sensor.x, 45 + (0.1 - 0.0149) / 0.0013625, 1e-9);
  EXPECT_NEAR(sensor.y, 455 - (0.1 + 0.0094) / 0.0013625, 1e-9);
}

TEST(ToioMatFrame, AQuarterTurnTurnsCounterClockwise) {
  const PlanFrame frame{.scale = 0.02, .quarter_turns = 1, .origin = {0.5, 0.1}};
  const Pose desk = frame.to_desk({10.0, 0.0, 0.0});
  EXPECT_NEAR(desk.x, 0.5, 1e-12);
  EXPECT_NEAR(desk.y, 0.3, 1e-12);
  EXPECT_NEAR(desk.theta, kPi / 2, 1e-12);
}

// Whole dots and degrees cost half a dot per axis and half a degree: together 0.71 dot.
TEST(ToioMatFrame, TheRoundTripLosesNoMoreThanTheRounding) {
  std::mt19937 dice(7);
  const auto between = [&](double low, double high) {
    return low + (high - low) * double(dice()) / 4294967295.0;
  };
  for (int i = 0; i < 20'000; ++i) {
    const PlanFrame plan{.scale = between(0.01, 0.05),
                         .quarter_turns = int(dice() % 4),
                         .origin = {between(0.0, 0.5), between(0.0, 0.5)}};
    const DeskFrame desk = desk_frame(dice() % 2 == 0 ? Facing::kNoseFirst : Facing::kTailFirst);
    const Pose pose{between(-10, 10), between(-10, 10), between(-kPi, kPi)};
    const MatPose exact = desk.to_mat(plan.to_desk(pose));
    const MatPose back = desk.to_mat(plan.to_desk(plan.to_plan(desk.to_desk(rounded(exact)))));
    EXPECT_LE(std::hypot(back.x - exact.x, back.y - exact.y), 0.7072);
    EXPECT_LE(std::abs(std::remainder(back.degrees - exact.degrees, 360.0)), 0.5 + 1e-9);
    const Pose again = plan.to_plan(desk.to_desk(exact));
    EXPECT_NEAR(again.x, pose.x, 1e-9);
    EXPECT_NEAR(again.y, pose.y, 1e-9);
    EXPECT_NEAR(wrap_to_pi(again.theta - pose.theta), 0.0, 1e-9);
  }
}

}  // namespace
}  // namespace mvtp
