#include "tools/toio/emulator/cube_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tools/toio/cube/predictor.hpp"

namespace mvtp {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kPi = std::numbers::pi;

/// A cube in the middle of the ring mat, nose to the right.
CubeModel cube_at(double theta = 0.0) {
  return {find_mat("collection-ring"), Cube{}, {0.28, 0.28, theta}, {}};
}

void write(CubeModel& cube, const CubeCommand& command) {
  const Write frame = encode(command);
  cube.write(frame.to, frame.bytes);
}

/// The events of so many seconds but for the positions.
std::vector<CubeEvent> live(CubeModel& cube, double seconds) {
  std::vector<CubeEvent> events;
  for (double t = 0.0; t < seconds - 1e-9; t += 0.005) {
    cube.step(0.005);
    for (const Notification& n : cube.take_notifications()) {
      const CubeEvent event = decode_event(n.from, n.bytes).value();
      if (!std::holds_alternative<PositionId>(event)) events.push_back(event);
    }
  }
  return events;
}

TEST(ToioCubeModel, WheelsTurnAsFastAsTheirUnits) {
  CubeModel cube = cube_at();
  write(cube, DriveOn{{20, 20}});
  live(cube, 1.0);
  EXPECT_NEAR(cube.pose().x - 0.28, 20 * 0.002814 * (1.0 - kMotorTime), 1e-4);
  EXPECT_NEAR(cube.pose().y, 0.28, 1e-9);
}

TEST(ToioCubeModel, WheelsStandBelowTheDeadZone) {
  CubeModel cube = cube_at();
  write(cube, DriveOn{{7, -7}});
  live(cube, 1.0);
  EXPECT_EQ(cube.pose(), (Pose{0.28, 0.28, 0.0}));
}

//   The right wheel alone turns the cube to the left around the left one.
TEST(ToioCubeModel, TheFasterWheelIsOnTheOutside) {
  CubeModel cube = cube_at();
  write(cube, DriveOn{{0, 20}});
  live(cube, 0.3);
  EXPECT_GT(cube.pose().theta, 0.1);
  EXPECT_GT(cube.pose().y, 0.28);
}

TEST(ToioCubeModel, ACommandEndsAfterItsTime) {
  CubeModel cube = cube_at();
  write(cube, DriveFor{{50, 50}, 25});
  live(cube, 0.25);
  EXPECT_GT(cube.wheel_speed_now(), 0.1);
  live(cube, 0.4);
  EXPECT_LT(cube.wheel_speed_now(), 0.001);
}

TEST(ToioCubeModel, PositionsAreWholeDotsOfTheCentre) {
  CubeModel cube = cube_at(kPi / 2);
  write(cube, NotifyId{1, NotifyWhen::kAlways});
  cube.step(0.005);
  const auto notifications = cube.take_notifications();
  const auto event = decode_event(notifications.back().from, notifications.back().bytes);
  const auto position = std::get<PositionId>(event.value());
  EXPECT_EQ(position.degrees, 270);
  EXPECT_EQ(position.x, std::lround(45 + 0.28 / 0.0013625));
  EXPECT_EQ(position.y, std::lround(455 - (0.28 - 0.0038) / 0.0013625));
}

TEST(ToioCubeModel, ATargetIsReachedAndTold) {
  for (const TargetMovement movement :
       {TargetMovement::kCurve, TargetMovement::kCurveForward, TargetMovement::kTurnThenMove}) {
    for (const double theta : {0.0, 2.0, -2.5}) {
      CubeModel cube = cube_at(theta);
      write(cube, GoTo{{.id = 9, .movement = movement, .max_speed = 40},
                       {320, 200, AngleRule::kShorter, 90}});
      EXPECT_THAT(live(cube, 6.0), ElementsAre(CubeEvent(TargetDone{false, 9})));
      const DeskFrame desk{find_mat("collection-ring"), Cube{}, Facing::kNoseFirst};
      const MatPose end = desk.to_mat(cube.pose());
      EXPECT_LE(std::hypot(end.x - 320, end.y - 200), 15.0);
      EXPECT_NEAR(end.degrees, 90, 6.0);
    }
  }
}

TEST(ToioCubeModel, ListsGoOnWithWhatWasAppended) {
  CubeModel cube = cube_at();
  const auto list = [](std::uint8_t id, bool append, std::uint16_t x) {
    return GoThrough{{.id = id, .max_speed = 60}, append, {{x, 250, AngleRule::kAny, 0}}};
  };
  write(cube, list(1, false, 280));
  write(cube, list(2, true, 310));
  write(cube, list(3, true, 340));
  const auto done = [](std::uint8_t id, TargetResult result) {
    return CubeEvent(TargetDone{true, id, result});
  };
  EXPECT_THAT(live(cube, 5.0),
              ElementsAre(done(3, TargetResult::kCannotAppend), done(1, TargetResult::kReached),
                          done(2, TargetResult::kReached)));
}

TEST(ToioCubeModel, TargetsEndForAReason) {
  const auto last = [](const TargetMode& mode, const Target& target, const CubeCommand& then) {
    CubeModel cube = cube_at();
    write(cube, GoTo{mode, target});
    write(cube, then);
    const auto events = live(cube, 3.0);
    return events.empty() ? TargetResult::kReached : std::get<TargetDone>(events.front()).result;
  };
  const Target far{400, 400, AngleRule::kAny, 0};
  EXPECT_EQ(last({.timeout_s = 1, .max_speed = 10}, far, LightOff{}), TargetResult::kTimeout);
  EXPECT_EQ(last({.max_speed = 9}, far, LightOff{}), TargetResult::kTooSlow);
  EXPECT_EQ(last({.max_speed = 40}, far, DriveOn{}), TargetResult::kOverwritten);
}

TEST(ToioCubeModel, TheEdgeOfTheMatIsTold) {
  CubeModel cube = cube_at();
  write(cube, DriveOn{{100, 100}});
  EXPECT_THAT(live(cube, 2.0), Contains(CubeEvent(PositionMissed{})));
}

TEST(ToioCubeModel, ACubeWithoutLinkStops) {
  CubeModel cube = cube_at();
  write(cube, DriveOn{{50, 50}});
  live(cube, 0.2);
  cube.disconnect();
  live(cube, 0.4);
  EXPECT_LT(cube.wheel_speed_now(), 0.001);
  write(cube, DriveFor{{50, 50}, 25});
  cube.disconnect();
  live(cube, 0.2);
  EXPECT_GT(cube.wheel_speed_now(), 0.1);
  live(cube, 0.4);
  EXPECT_LT(cube.wheel_speed_now(), 0.001);
}

TEST(ToioCubeModel, SettingsAreAnswered) {
  CubeModel cube = cube_at();
  write(cube, NotifyId{1, NotifyWhen::kAlways});
  write(cube, AskVersion{});
  EXPECT_THAT(live(cube, 0.01),
              ElementsAre(CubeEvent(SettingDone{0x98, 0}), CubeEvent(Version{"2.4.0"})));
}

// A cube that stands says nothing unless told to: silence must mean trouble.
TEST(ToioCubeModel, ByDefaultItGoesQuietAtRest) {
  CubeModel cube = cube_at();
  live(cube, 0.5);
  cube.step(0.01);
  EXPECT_THAT(cube.take_notifications(), IsEmpty());
}

// The predictor -------------------------------------------------------------------------------

//   Commands take 0.1 s to the wheels; the report of 0.1 s ago and the commands since then give
//   where the cube is when the next command arrives.
TEST(ToioPredictor, ReplaysWhatHasNotShownYet) {
  CubeModel cube = cube_at();
  Predictor predictor(Cube{}, Facing::kNoseFirst, 0.1);
  const std::vector<WheelUnits> commands = {{20, 20}, {30, 20}, {10, 25}, {40, 40}, {-20, 15}};
  EXPECT_FALSE(predictor.at(0.0));
  predictor.measured(cube.pose(), 0.0);
  for (std::size_t k = 0; k < commands.size(); ++k) {
    const double now = 0.05 * double(k);
    if (k <= 2) predictor.measured(cube_at().pose(), now);  // what was sent has not arrived yet
    predictor.sent(commands[k], now);
    if (k >= 2) write(cube, DriveOn{commands[k - 2]});
    if (k >= 2) live(cube, 0.05);
    if (k >= 2) predictor.measured(cube.pose(), now + 0.05);
  }
  for (const std::size_t k : {3U, 4U}) {
    write(cube, DriveOn{commands[k]});
    live(cube, 0.05);
  }
  const Pose predicted = predictor.at(0.25).value();
  EXPECT_NEAR(predicted.x, cube.pose().x, 3e-4);
  EXPECT_NEAR(predicted.y, cube.pose().y, 3e-4);
  EXPECT_NEAR(predicted.theta, cube.pose().theta, 0.02);
}

TEST(ToioPredictor, TailFirstIsTheSameWorldSeenFromBehind) {
  Predictor predictor(Cube{}, Facing::kTailFirst, 0.1);
  predictor.measured({0.0, 0.0, 0.0}, 0.0);
  predictor.sent(wheel_units(Cube{}, Facing::kTailFirst, {0.06, 0.5}), 0.0);
  const Pose pose = predictor.at(0.5).value();
  EXPECT_GT(pose.x, 0.02);
  EXPECT_GT(pose.theta, 0.1);
}

}  // namespace
}  // namespace mvtp
