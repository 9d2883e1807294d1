// Who is expected where behind its exit: leaders that were handed back, or were never under
// control.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/coordinator/predictions.hpp"

namespace mvtp {
namespace {

using testing::SizeIs;

TEST(Leaders, ALeaderBehindTheExitIsKnownByItsExitLane) {
  Prediction p(chain_shape());
  const int exit = p.walk.graph.find_lane("B-E_0");
  for (const double position : {10.0, 40.0, 70.0}) {
    const auto forecasts = p.predict("B-E_0", position, 9.0, {"B-E"}, Intent::kWaits);
    ASSERT_THAT(forecasts, SizeIs(1)) << position;
    const RoadVehicle& v = forecasts[0].vehicle;
    EXPECT_EQ(v.exit_lane, exit);
    EXPECT_NEAR(v.now.s - v.s_exit_lane, position, 0.5) << "behind the start of the exit lane";
    EXPECT_NEAR(forecasts[0].earliest.at(7 + 20).v, 9.0, 1e-9) << "it holds its speed at first";
  }
}

TEST(Leaders, ExitsReachOverJunctionsWithoutConflicts) {
  const Prediction p(seam_shape());
  const ExitRoot near = p.predictor.exit_root(p.walk.graph.find_lane("C-D_0"));
  const ExitRoot far = p.predictor.exit_root(p.walk.graph.find_lane("D-W_0"));
  EXPECT_EQ(near.lane, p.walk.graph.find_lane("C-D_0"));
  EXPECT_EQ(near.offset, 0.0);
  EXPECT_EQ(far.lane, near.lane);
  EXPECT_GT(far.offset, p.shape.network.lanes.at("C-D_0").length);
  EXPECT_EQ(p.predictor.exit_root(p.walk.graph.find_lane("S-C_0")).lane, LaneGraph::kNone);
}

TEST(Leaders, ALeaderStaysOnTheCorridorThatItWasHandedBackOn) {
  Prediction p(crossroads_shape());
  const auto course = p.walk.finder.find(p.walk.at("W-C_0", 60.0, {"W-C", "C-E"}));
  const int corridor = p.map.corridor_for(*course, p.car);
  p.predictor.handed_back("v", corridor);
  const int path = p.map[corridor].path;
  p.map.forget_unused();
  for (int round = 0; round < 3; ++round) {
    const auto forecasts = p.predict("C-E_0", 20.0, 9.0, {"C-E"}, Intent::kWaits);
    ASSERT_THAT(forecasts, SizeIs(1));
    EXPECT_EQ(forecasts[0].vehicle.path, path);
    p.map.forget_unused();
    p.predictor.corridors_forgotten();
  }
  p.map.forget_unused();
  p.predictor.corridors_forgotten();
  EXPECT_NE(p.predict("C-E_0", 20.0, 9.0, {"C-E"}, Intent::kWaits)[0].vehicle.path, path);
}

TEST(Leaders, ALeaderThatTurnsElsewhereLeavesItsCorridor) {
  Prediction p(fan_out_shape());
  CourseQuery query = p.walk.at("W-C_0", 60.0, {"W-C", "C-E"});
  query.next_lane = p.walk.graph.find_lane("C-E_0");
  const CorridorCourse course = p.walk.finder.follow(query, 200.0);
  p.predictor.handed_back("v", p.map.corridor_for(course, p.car));
  const auto end = [&](const std::string& to, const std::string& next_lane) {
    const auto forecasts =
        p.predict("W-C_0", 60.0, 12.0, {"W-C", to}, Intent::kPasses, {}, next_lane);
    return p.place(forecasts.at(0), 7 + 150);
  };
  const auto place_of = [&](const std::string& lane) {
    return p.shape.network.lanes.at(lane).shape.back();
  };
  EXPECT_NEAR(end("C-E", "").y, place_of("C-E_0").y, 0.1);
  EXPECT_NEAR(end("C-E", "C-E_1").y, place_of("C-E_1").y, 0.1);
  p.predictor.handed_back("v", p.map.corridor_for(course, p.car));
  EXPECT_NEAR(end("C-S", "").x, place_of("C-S_0").x, 0.1);
}

}  // namespace
}  // namespace mvtp
