#include <cmath>
#include <numbers>
#include <string>

#include "planner/problem/input_error.hpp"
#include "tests/tools/program_fixture.hpp"
#include "tools/view/read_replay.hpp"
#include "tools/view/svg.hpp"

namespace mvtp {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// Two cars in three frames, one second apart; b comes in the second one.
Replay two_cars(ReplayMotion motion = ReplayMotion::kContinuous) {
  ReplayInfo info;
  info.title = "a < b";
  info.motion = motion;
  ReplayRecorder recorder(info, {.zones = {{{0, 0}, {5, 0}, {5, 5}}}, .border = Point{30, 20}},
                          0.0);
  recorder.add_vehicle({.id = "a&a"});
  recorder.add_vehicle({.id = "b", .goal = Pose{9, 9, 0}});
  const ReplayVehicleState a{0, {1.25, -2.5, 0.0}, 1.0, ReplayState::kCoordinated};
  recorder.add_frame(0.0, std::vector{a}, 0.5);
  ReplayVehicleState turned{0, drive(a.pose, 2.0, 0.5), 2.0, ReplayState::kCoordinated};
  const ReplayVehicleState b{1, {20, 10, std::numbers::pi}, -3.0, ReplayState::kWaiting};
  recorder.add_frame(1.0, std::vector{turned, b}, 0.5);
  recorder.add_frame(2.0, std::vector{b}, 0.5);
  return recorder.finish();
}

TEST(Frames, AreThoseThatWereRecorded) {
  const ReplayFrames frames = frames_of(two_cars(), "r");
  ASSERT_EQ(frames.times, (std::vector<double>{0.0, 1.0, 2.0}));
  ASSERT_EQ(frames.states[0].size(), 1U);
  ASSERT_EQ(frames.states[1].size(), 2U);
  ASSERT_EQ(frames.states[2].size(), 1U);
  const ReplayVehicleState& b = frames.states[2][0];
  EXPECT_EQ(b.vehicle, 1U);
  EXPECT_EQ(b.state, ReplayState::kWaiting);
  EXPECT_NEAR(b.pose.x, 20.0, 1e-9);
  EXPECT_NEAR(std::abs(b.pose.theta), std::numbers::pi, 1e-3);
  EXPECT_NEAR(b.speed, -3.0, 1e-9);
  EXPECT_NEAR(frames.states[0][0].pose.y, -2.5, 1e-9);
}

TEST(Frames, BetweenTwoOfThemACarIsOnItsArc) {
  const ReplayFrames frames = frames_of(two_cars(), "r");
  const Pose middle = drive({1.25, -2.5, 0.0}, 1.0, 0.5);
  const auto states = states_at(frames, 0.5);
  ASSERT_EQ(states.size(), 1U);
  EXPECT_NEAR(states[0].pose.x, middle.x, 0.01);
  EXPECT_NEAR(states[0].pose.y, middle.y, 0.01);
  EXPECT_NEAR(states[0].pose.theta, middle.theta, 1e-3);
  EXPECT_TRUE(states_at(frames, -0.1).empty());
}

TEST(Frames, APlansSpeedIsThatOfTheStepThatIsGoingOn) {
  EXPECT_NEAR(states_at(frames_of(two_cars(ReplayMotion::kSteps), "r"), 0.5)[0].speed, 2.0, 1e-9);
  EXPECT_NEAR(states_at(frames_of(two_cars(), "r"), 0.5)[0].speed, 1.0, 1e-9);
}

TEST(Frames, DamageIsTold) {
  Replay replay = two_cars();
  replay.frames.resize(replay.frames.size() / 2);
  EXPECT_THROW((void)frames_of(replay, "r"), InputError);
}

TEST(Svg, ShowsWhoIsThereAndEscapesText) {
  const std::string svg = to_svg(two_cars(), 1.0, "r");
  EXPECT_THAT(svg, HasSubstr("<title>a &lt; b, 1 s</title>"));
  EXPECT_THAT(svg, HasSubstr("<title>a&amp;a</title>"));
  EXPECT_THAT(svg, HasSubstr("translate(20.00 10.00) rotate(180.0)"));
  EXPECT_THAT(svg, HasSubstr("translate(9.00 9.00) rotate(0.0)"));
  EXPECT_THAT(svg, HasSubstr("#cc3d93"));  // b reverses
}

TEST(Svg, ShowsLightsAndPeople) {
  ReplayScene scene;
  scene.lights = {{.signal = 0, .index = 1, .from = {1, 1}, .to = {1, 4}}};
  ReplayRecorder recorder({.title = "x"}, scene, 0.0);
  recorder.add_lights(0.0, recorder.add_signal("s"), "rG");
  ReplayVehicle person{.id = "p", .length = 0.5, .width = 0.5, .front = 0.25};
  person.person = true;
  recorder.add_vehicle(person);
  recorder.add_frame(0.0,
                     std::vector<ReplayVehicleState>{{0, {3, 4, 0}, 1.0, ReplayState::kWalking}});
  const std::string svg = to_svg(recorder.finish(), 0.0, "r");
  EXPECT_THAT(svg, HasSubstr("points=\"1.00,1.00 1.00,4.00 \" stroke=\"#009e73\""));
  EXPECT_THAT(svg, HasSubstr("<circle cx=\"3.00\" cy=\"4.00\" r=\"0.25\""));
}

TEST(Svg, OnlyMomentsOfTheReplayCanBeDrawn) {
  EXPECT_THROW((void)to_svg(two_cars(), 2.1, "r"), InputError);
}

using View = Program;

TEST_F(View, DrawsAMoment) {
  (void)directory_.file("i.yaml",
                        "agents:\n  - {start: [5, 5, 0], goal: [9, 5, 0]}\n"
                        "map: {dimensions: [20, 20]}\n");
  ASSERT_EQ(run("solve -i i.yaml -q -o p.yaml").exit_code, 0);
  ASSERT_EQ(run("view p.yaml -i i.yaml --at 1.5 -o m.svg").exit_code, 0);
  EXPECT_THAT(content_of(directory_.path("m.svg")), HasSubstr("translate(6.50 5.00)"));
  ASSERT_EQ(run("view p.yaml -i i.yaml --at 1.5 -o m.png").exit_code, 0);
  EXPECT_THAT(content_of(directory_.path("m.png")), StartsWith("\x89PNG"));
  EXPECT_THAT(
      shell(std::string("PATH= '") + MVTP_PROGRAM + "' view p.yaml -i i.yaml --at 1 -o n.png").err,
      HasSubstr("--output: a PNG needs rsvg-convert; install librsvg2-bin"));
  expect_refused("view p.yaml -i i.yaml --at 99 -o n.svg", "--at: is 99 s; p.yaml goes from 0 .*");
  expect_refused("view p.yaml -i i.yaml --at 1 -o n.html", "--output: is n.html; give a name .*");
  expect_refused("view p.yaml -i i.yaml -o n.svg", "--output: is n.svg; give a name .*");
  expect_refused("view p.yaml p.yaml -i i.yaml --at 1 -o n.svg", "--at: draws one replay; .*");
  EXPECT_EQ(shell("ls").out, "i.yaml\nm.png\nm.svg\np.yaml\n");
}

TEST_F(View, TakesTheFolderOfARunForThePageInIt) {
  (void)directory_.file("i.yaml",
                        "agents:\n  - {start: [5, 5, 0], goal: [9, 5, 0]}\n"
                        "map: {dimensions: [20, 20]}\n");
  ASSERT_EQ(shell("mkdir run").exit_code, 0);
  expect_refused("view run -o both.html",
                 "run/view.html: is missing; give a page, a plan, or the folder .*");
  ASSERT_EQ(run("view i.yaml -o run/view.html").exit_code, 0);
  ASSERT_EQ(run("view run/view.html -o page.html").exit_code, 0);
  ASSERT_EQ(run("view run -o folder.html").exit_code, 0);
  EXPECT_EQ(content_of(directory_.path("folder.html")), content_of(directory_.path("page.html")));
  expect_refused("view run -o run/view.html", "run/view.html: is an input too.*");
}

}  // namespace
}  // namespace mvtp
