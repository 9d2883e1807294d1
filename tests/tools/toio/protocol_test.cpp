#include "tools/toio/cube/protocol.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <utility>

#include "tests/tools/toio/protocol_laws.hpp"

namespace mvtp {
namespace {

using testing::Eq;
using testing::Optional;

struct GoldenCommand {
  const char* name;
  CubeCommand command;
  Characteristic to;
  const char* hex;
};

/// Frames of the toio Core Cube Specification's examples and, where it has none, of its tables.
std::vector<GoldenCommand> golden_commands() {
  const TargetMode example{.timeout_s = 5, .max_speed = 0x50};
  using C = Characteristic;
  return {
      {"stop", DriveOn{}, C::kMotor, "01 01 01 00 02 01 00"},
      {"drive 200 ms", DriveFor{{30, -20}, 20}, C::kMotor, "02 01 01 1e 02 02 14 14"},
      {"one target", GoTo{example, {700, 386, AngleRule::kShorter, 90}}, C::kMotor,
       "03 00 05 00 50 00 00 bc 02 82 01 5a 00"},
      {"a target without angle",
       GoTo{{.id = 7, .timeout_s = 5, .max_speed = 40}, {250, 250, AngleRule::kAny, 0}}, C::kMotor,
       "03 07 05 00 28 00 00 fa 00 fa 00 00 a0"},
      {"three targets appended",
       GoThrough{example,
                 true,
                 {{100, 100, AngleRule::kShorter, 0},
                  {200, 100, AngleRule::kShorter, 0x5f},
                  {200, 200, AngleRule::kShorter, 180}}},
       C::kMotor, "04 00 05 00 50 00 00 01 64 00 64 00 00 00 c8 00 64 00 5f 00 c8 00 c8 00 b4 00"},
      {"acceleration", Accelerate{.speed = 50, .change = 5, .turn_deg_s = 15, .tens_of_ms = 100},
       C::kMotor, "05 32 05 0f 00 00 00 00 64"},
      {"positions always", NotifyId{1, NotifyWhen::kAlways}, C::kConfiguration, "18 00 01 00"},
      {"missed after 100 ms", NotifyIdMissed{10}, C::kConfiguration, "19 00 0a"},
      {"wheel speeds", NotifyWheelSpeeds{true}, C::kConfiguration, "1c 00 01"},
      {"interval", AskInterval{8, 12}, C::kConfiguration, "30 00 08 00 0c 00"},
      {"version", AskVersion{}, C::kConfiguration, "01 00"},
      {"red light", LightOn{16, 255, 0, 0}, C::kLight, "03 10 01 01 ff 00 00"},
      {"light off", LightOff{}, C::kLight, "01"},
  };
}

TEST(ToioProtocol, CommandsAreTheSpecifiedBytes) {
  for (const GoldenCommand& golden : golden_commands()) {
    const Write write = encode(golden.command);
    EXPECT_EQ(write.to, golden.to) << golden.name;
    EXPECT_EQ(to_hex(write.bytes), golden.hex) << golden.name;
  }
}

TEST(ToioProtocol, TheSpecifiedBytesAreTheCommands) {
  for (const GoldenCommand& golden : golden_commands()) {
    const auto bytes = from_hex(golden.hex);
    ASSERT_TRUE(bytes) << golden.name;
    EXPECT_THAT(decode_command(golden.to, *bytes), Optional(Eq(golden.command))) << golden.name;
  }
}

struct GoldenEvent {
  const char* name;
  CubeEvent event;
  Characteristic from;
  const char* hex;
};

std::vector<GoldenEvent> golden_events() {
  using C = Characteristic;
  return {
      {"position", PositionId{709, 383, 306, 700, 386, 306}, C::kId,
       "01 c5 02 7f 01 32 01 bc 02 82 01 32 01"},
      {"standard id", StandardId{0x380000, 21}, C::kId, "02 00 00 38 00 15 00"},
      {"position missed", PositionMissed{}, C::kId, "03"},
      {"standard missed", StandardMissed{}, C::kId, "04"},
      {"target reached", TargetDone{false, 7, TargetResult::kReached}, C::kMotor, "83 07 00"},
      {"targets refused", TargetDone{true, 1, TargetResult::kCannotAppend}, C::kMotor, "84 01 07"},
      {"wheel speeds", WheelSpeeds{10, 20}, C::kMotor, "e0 0a 14"},
      {"button", Button{true}, C::kButton, "01 80"},
      {"button let go", Button{false}, C::kButton, "01 00"},
      {"battery", Battery{90}, C::kBattery, "5a"},
      {"collision", Motion{true, true, false, 1, 0}, C::kSensor, "01 01 01 00 01 00"},
      {"version", Version{"2.4.0"}, C::kConfiguration, "81 00 32 2e 34 2e 30"},
      {"setting done", SettingDone{0x98, 0}, C::kConfiguration, "98 00 00"},
  };
}

TEST(ToioProtocol, EventsAreTheSpecifiedBytesBothWays) {
  for (const GoldenEvent& golden : golden_events()) {
    const Notification notification = encode(golden.event);
    EXPECT_EQ(notification.from, golden.from) << golden.name;
    EXPECT_EQ(to_hex(notification.bytes), golden.hex) << golden.name;
    EXPECT_THAT(decode_event(golden.from, from_hex(golden.hex).value()), Optional(Eq(golden.event)))
        << golden.name;
  }
}

TEST(ToioProtocol, WhatACubeDropsIsNoCommand) {
  using C = Characteristic;
  const std::pair<C, const char*> dropped[] = {
      {C::kMotor, "01 01 01 00 01 01 00"},                       // the same wheel twice
      {C::kMotor, "01 01 03 00 02 01 00"},                       // no such direction
      {C::kMotor, "01 03 01 00 02 01 00"},                       // no such wheel
      {C::kMotor, "02 01 01 1e 02 02 14"},                       // too short
      {C::kMotor, "01 01 01 00 02 01 00 00"},                    // too long
      {C::kMotor, "03 00 05 03 50 00 00 bc 02 82 01 5a 00"},     // no such movement
      {C::kMotor, "03 00 05 00 50 04 00 bc 02 82 01 5a 00"},     // no such speed change
      {C::kMotor, "03 00 05 00 50 00 00 bc 02 82 01 00 e0"},     // no such angle rule
      {C::kMotor, "04 00 05 00 50 00 00 01"},                    // no target
      {C::kMotor, "04 00 05 00 50 00 00 02 64 00 64 00 00 00"},  // append is 0 or 1
      {C::kMotor, "05 32 05 0f 00 02 00 00 64"},                 // no such direction
      {C::kMotor, "06"},                                         // no such type
      {C::kConfiguration, "18 00 01 02"},                        // no such condition
      {C::kConfiguration, "18"},
      {C::kLight, "03 10 02 01 ff 00 00"},  // one lamp only
      {C::kId, "01 00"},                    // nothing can be written there
  };
  for (const auto& [to, hex] : dropped) {
    EXPECT_FALSE(decode_command(to, from_hex(hex).value())) << hex;
  }
  GoThrough many{.targets = std::vector<Target>(kMaxTargets)};
  EXPECT_TRUE(decode_command(C::kMotor, encode(many).bytes));
  many.targets.emplace_back();
  EXPECT_FALSE(decode_command(C::kMotor, encode(many).bytes));
}

TEST(ToioProtocol, WhatNoCubeSendsIsNoEvent) {
  using C = Characteristic;
  const std::pair<C, const char*> wrong[] = {
      {C::kId, "01 c5 02 7f 01 69 01 bc 02 82 01 32 01"},  // 361 degrees
      {C::kId, "01 c5 02"},
      {C::kId, "03 00"},
      {C::kMotor, "85 00 00"},
      {C::kMotor, "83 00 08"},
      {C::kBattery, "65"},
      {C::kConfiguration, "81 00 07"},  // a version that cannot be printed
      {C::kLight, "01"},
  };
  for (const auto& [from, hex] : wrong) {
    EXPECT_FALSE(decode_event(from, from_hex(hex).value())) << hex;
  }
  for (const C from : kCharacteristics) EXPECT_FALSE(decode_event(from, {}));
}

/// Random bytes, most of them near a frame that means something.
Bytes garbage(std::mt19937& dice) {
  Bytes bytes;
  const auto commands = golden_commands();
  const auto events = golden_events();
  const auto kind = dice() % 3;
  if (kind == 0) bytes = from_hex(commands[dice() % commands.size()].hex).value();
  if (kind == 1) bytes = from_hex(events[dice() % events.size()].hex).value();
  if (dice() % 2 == 0) bytes.resize(dice() % 40);
  for (auto n = dice() % 4; n > 0 && !bytes.empty(); --n) {
    bytes[dice() % bytes.size()] = static_cast<std::uint8_t>(dice());
  }
  return bytes;
}

TEST(ToioProtocol, DecodingSurvivesGarbage) {
  std::mt19937 dice(1);
  int understood = 0;
  for (int i = 0; i < 200'000; ++i) {
    const Bytes bytes = garbage(dice);
    ASSERT_EQ(broken_law(bytes, understood), std::nullopt);
  }
  EXPECT_GT(understood, 50'000);
}

TEST(ToioProtocol, CharacteristicsAreKnownByTheirUuid) {
  EXPECT_EQ(uuid(Characteristic::kMotor), "10b20102-5b3b-4571-9508-cf3efcd7bbae");
  EXPECT_EQ(characteristic_of("10B201FF-5B3B-4571-9508-CF3EFCD7BBAE"),
            Characteristic::kConfiguration);
  EXPECT_EQ(characteristic_of("10b20105-5b3b-4571-9508-cf3efcd7bbae"), std::nullopt);
  for (const Characteristic characteristic : kCharacteristics) {
    EXPECT_EQ(characteristic_of(uuid(characteristic)), characteristic);
  }
}

TEST(ToioProtocol, HexadecimalTextIsReadStrictly) {
  EXPECT_EQ(from_hex("0A ff"), (Bytes{0x0a, 0xff}));
  EXPECT_EQ(from_hex(""), Bytes{});
  for (const char* text : {"0", "0 1", "0a ", "0aff", "0g", "0a  ff", " 0a", "0a f"}) {
    EXPECT_EQ(from_hex(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace mvtp
