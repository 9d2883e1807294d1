#include "tools/report/time_space.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "planner/problem/input_error.hpp"
#include "tools/report/marks_on_path.hpp"

namespace mvtp {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kFront = 3.0;  // [m]

/// A road from x = 0 to 200 m with a stop line at 100 m and a junction behind it. The lane beside
/// it leads the other way.
ReplayScene road() {
  ReplayScene scene;
  scene.lanes = {
      {.shape = {{0, 0}, {100, 0}}, .stop_line = true},
      {.shape = {{100, 0}, {115, 0}}, .internal = true, .stop_line = true},
      {.shape = {{115, 0}, {200, 0}}},
      {.shape = {{200, 3.2}, {115, 3.2}}, .stop_line = true},
      {.shape = {{107, -90}, {107, -8}}, .stop_line = true},
  };
  scene.junctions = {{{100, -8}, {115, -8}, {115, 8}, {100, 8}}};
  scene.lights = {{.signal = 0, .index = 1, .from = {100, -1.6}, .to = {100, 1.6}},
                  {.signal = 0, .index = 0, .from = {100, -1.6}, .to = {100, 1.6}}};
  scene.lights[0].target = Point{115, 0};
  scene.lights[1].target = Point{107, -8};
  scene.corridors = {{0, {{40, 0}, {107, 0}, {160, 0}}}, {0, {{40, 0}, {107, 0}, {107, -60}}}};
  return scene;
}

ReplayVehicle car(const char* id, const char* movement) {
  ReplayVehicle vehicle{.id = id, .length = 4.0, .front = kFront};
  vehicle.movement = movement;
  return vehicle;
}

/// Ten seconds, a frame each second. "a" and "b" go along the road at 20 and 10 m/s, a is under
/// control from 4 s on; "c" turns right at the junction; "d" comes across.
Replay run_on_road() {
  ReplayRecorder recorder({.title = "x"}, road(), 0.0);
  const std::size_t a = recorder.add_vehicle(car("a", "W>E"));
  ReplayVehicle human = car("b", "W>E");
  human.automated = false;
  const std::size_t b = recorder.add_vehicle(human);
  const std::size_t c = recorder.add_vehicle(car("c", "W>S"));
  const std::size_t d = recorder.add_vehicle(car("d", "S>N"));
  const std::size_t signal = recorder.add_signal("C");
  for (int t = 0; t <= 9; ++t) {
    recorder.add_lights(t, signal, t < 3 ? "Gr" : t < 5 ? "rG" : "rg");
    std::vector<ReplayVehicleState> now;
    now.push_back({a,
                   {20.0 * t - kFront, 0, 0},
                   20.0,
                   t < 4 ? ReplayState::kCarFollowing : ReplayState::kCoordinated});
    now.push_back({b, {10.0 * t - kFront, 0, 0}, 10.0, ReplayState::kCarFollowing});
    const bool turned = t > 5;
    now.push_back(
        {c,
         turned ? Pose{107, -20.0 * (t - 5), -std::numbers::pi / 2} : Pose{20.0 * t - kFront, 0, 0},
         20.0, ReplayState::kCarFollowing});
    now.push_back(
        {d, {107, -50.0 + 10.0 * t, std::numbers::pi / 2}, 10.0, ReplayState::kCarFollowing});
    recorder.add_frame(t, now);
  }
  return recorder.finish();
}

TimeSpaceDiagram diagram_of(const Replay& replay, const TimeSpaceRequest& request = {}) {
  const std::vector<LabelledReplay> runs = {{"one", "one.html", &replay}};
  return time_space_of(runs, request);
}

TEST(TimeSpace, StationsAreThoseOfFrontBumpers) {
  const TimeSpaceDiagram diagram = diagram_of(run_on_road());
  EXPECT_EQ(diagram.movement, "W>E");  // that of most vehicles
  EXPECT_NEAR(diagram.length, 180.0, 0.3);
  ASSERT_THAT(diagram.panels, SizeIs(1));
  const auto& lines = diagram.panels[0].lines;
  ASSERT_THAT(lines, SizeIs(3));  // a before its takeover, under control, and b
  EXPECT_NEAR(lines[1].stations.front(), 60.0, 0.1);
  EXPECT_NEAR(lines[1].stations.back(), 180.0, 0.1);
  EXPECT_THAT(lines[2].times, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9));
  for (std::size_t i = 0; i < lines[2].times.size(); ++i) {
    EXPECT_NEAR(lines[2].stations[i], 10.0 * lines[2].times[i], 0.1);
  }
}

TEST(TimeSpace, TheDriverIsSaidOfEachPieceAndPiecesMeet) {
  const auto lines = diagram_of(run_on_road()).panels[0].lines;
  EXPECT_EQ(lines[0].driver, "sumo");
  EXPECT_EQ(lines[1].driver, "controlled");
  EXPECT_EQ(lines[2].driver, "human");
  EXPECT_EQ(lines[0].times.back(), lines[1].times.front());
  EXPECT_EQ(lines[0].stations.back(), lines[1].stations.front());
}

//   c drives ahead of them until it turns; d crosses the path and is not in its lane.
TEST(TimeSpace, OthersShowWhileTheyAreInTheSameLane) {
  const auto others = diagram_of(run_on_road()).panels[0].others;
  ASSERT_THAT(others, SizeIs(1));
  EXPECT_NEAR(others[0].stations.back(), 100.0, 0.1);
}

TEST(TimeSpace, TheRoadIsMarkedWhereItIs) {
  const TimeSpaceDiagram diagram = diagram_of(run_on_road());
  EXPECT_THAT(diagram.stop_lines, ElementsAre(DoubleNear(100.0, 0.3)));
  ASSERT_THAT(diagram.junctions, SizeIs(1));
  EXPECT_NEAR(diagram.junctions[0].from, 100.0, 0.5);
  EXPECT_NEAR(diagram.junctions[0].to, 115.0, 0.5);
  const auto& zones = diagram.panels[0].zones;
  ASSERT_THAT(zones, SizeIs(1));  // the corridor that turns is not on the path
  EXPECT_NEAR(zones[0].from, 40.0, 0.5);
  EXPECT_NEAR(zones[0].to, 160.0, 0.5);
}

//   The signal head for those who turn right stands at the same stop line.
TEST(TimeSpace, TheSignalIsThatOfTheMovement) {
  const auto signals = diagram_of(run_on_road(), {.begin = 1.0}).panels[0].signals;
  ASSERT_THAT(signals, SizeIs(1));
  EXPECT_NEAR(signals[0].station, 100.0, 0.3);
  ASSERT_THAT(signals[0].shown, SizeIs(2));
  EXPECT_EQ(signals[0].shown[0].light, 'r');
  EXPECT_EQ(signals[0].shown[0].time.from, 1.0);
  EXPECT_EQ(signals[0].shown[0].time.to, 3.0);
  EXPECT_EQ(signals[0].shown[1].light, 'g');  // with and without right of way
  EXPECT_EQ(signals[0].shown[1].time.to, 9.0);
}

TEST(TimeSpace, ShowsTheTimeAndTheMovementAskedFor) {
  const TimeSpaceDiagram diagram =
      diagram_of(run_on_road(), {.movement = "S>N", .begin = 2.0, .end = 6.0});
  ASSERT_THAT(diagram.panels[0].lines, SizeIs(1));
  EXPECT_THAT(diagram.panels[0].lines[0].times, ElementsAre(2, 3, 4, 5, 6));
  EXPECT_THAT(diagram.panels[0].others, IsEmpty());
}

TEST(TimeSpace, RunsShareTheirStations) {
  ReplayRecorder recorder({.title = "y"}, road(), 0.0);
  const std::size_t a = recorder.add_vehicle(car("a", "W>E"));
  for (int t = 0; t < 3; ++t) {
    recorder.add_frame(
        t, std::vector{ReplayVehicleState{
               a, {150.0 + 10.0 * t - kFront, 0, 0}, 10.0, ReplayState::kCarFollowing}});
  }
  const Replay late = recorder.finish();
  const Replay whole = run_on_road();
  const std::vector<LabelledReplay> runs = {{"late", "l", &late}, {"whole", "w", &whole}};
  const TimeSpaceDiagram diagram = time_space_of(runs, {});
  ASSERT_THAT(diagram.panels, SizeIs(2));
  EXPECT_EQ(diagram.panels[0].label, "late");
  EXPECT_NEAR(diagram.panels[0].lines[0].stations.front(), 150.0, 0.1);
}

TEST(TimeSpace, WhatIsNotThereIsTold) {
  const Replay replay = run_on_road();
  const auto refused = [&](const TimeSpaceRequest& request, const std::string& why) {
    try {
      (void)diagram_of(replay, request);
      ADD_FAILURE() << why;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(why));
    }
  };
  refused({.movement = "E>W"},
          "one.html: has no vehicle of the movement \"E>W\"; those of most vehicles are W>E, S>N");
  refused({.begin = 9.0}, "--begin: is 9; give a time before 9 s");
  refused({.begin = 5.0, .end = 4.0}, "--begin: is 5; give a time before 4 s");
}

}  // namespace
}  // namespace mvtp
