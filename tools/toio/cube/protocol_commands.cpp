// What is written to a cube, to and from bytes.

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "tools/toio/cube/protocol.hpp"
#include "tools/toio/cube/protocol_bytes.hpp"

namespace mvtp {
namespace {

// Lengths of the frames.
constexpr std::size_t kTargetBytes = 6;
constexpr std::size_t kListHeader = 8;

constexpr std::uint8_t kLeftWheel = 1;
constexpr std::uint8_t kRightWheel = 2;
constexpr std::uint8_t kForward = 1;
constexpr std::uint8_t kBackward = 2;

void put_wheel(Bytes& bytes, std::uint8_t wheel, int speed) {
  bytes.push_back(wheel);
  bytes.push_back(speed < 0 ? kBackward : kForward);
  bytes.push_back(static_cast<std::uint8_t>(std::min(std::abs(speed), 255)));
}

Bytes wheel_bytes(std::uint8_t type, const WheelUnits& speed) {
  Bytes bytes = {type};
  put_wheel(bytes, kLeftWheel, speed.left);
  put_wheel(bytes, kRightWheel, speed.right);
  return bytes;
}

/// Reads the two wheels, in either order, from bytes 1 to 6.
std::optional<WheelUnits> get_wheels(View bytes) {
  WheelUnits units;
  if (bytes[1] == bytes[4]) return std::nullopt;
  for (const std::size_t at : {1U, 4U}) {
    const std::uint8_t wheel = bytes[at];
    const std::uint8_t direction = bytes[at + 1];
    if (wheel != kLeftWheel && wheel != kRightWheel) return std::nullopt;
    if (direction != kForward && direction != kBackward) return std::nullopt;
    const int speed = direction == kBackward ? -int(bytes[at + 2]) : int(bytes[at + 2]);
    (wheel == kLeftWheel ? units.left : units.right) = speed;
  }
  return units;
}

Bytes mode_bytes(std::uint8_t type, const TargetMode& mode) {
  return {type,
          mode.id,
          mode.timeout_s,
          static_cast<std::uint8_t>(mode.movement),
          mode.max_speed,
          static_cast<std::uint8_t>(mode.speed_change),
          0};
}

std::optional<TargetMode> get_mode(View bytes) {
  if (bytes[3] > 2 || bytes[5] > 3) return std::nullopt;
  return TargetMode{bytes[1], bytes[2], static_cast<TargetMovement>(bytes[3]), bytes[4],
                    static_cast<SpeedChange>(bytes[5])};
}

void put_target(Bytes& bytes, const Target& target) {
  put16(bytes, target.x);
  put16(bytes, target.y);
  put16(bytes, (static_cast<unsigned>(target.rule) << 13U) | (target.degrees & 0x1fffU));
}

std::optional<Target> get_target(View bytes, std::size_t at) {
  const unsigned angle = get16(bytes, at + 4);
  const unsigned rule = angle >> 13U;
  if (rule > 6) return std::nullopt;
  return Target{get16(bytes, at), get16(bytes, at + 2), static_cast<AngleRule>(rule),
                static_cast<std::uint16_t>(angle & 0x1fffU)};
}

/// Turns a command into a write.
struct CommandEncoder {
  Write operator()(const DriveOn& c) const { return motor(wheel_bytes(kDriveOn, c.speed)); }
  Write operator()(const DriveFor& c) const {
    Bytes bytes = wheel_bytes(kDriveFor, c.speed);
    bytes.push_back(c.tens_of_ms);
    return motor(std::move(bytes));
  }
  Write operator()(const GoTo& c) const {
    Bytes bytes = mode_bytes(kGoTo, c.mode);
    put_target(bytes, c.target);
    return motor(std::move(bytes));
  }
  Write operator()(const GoThrough& c) const {
    Bytes bytes = mode_bytes(kGoThrough, c.mode);
    bytes.push_back(c.append ? 1 : 0);
    for (const Target& target : c.targets) put_target(bytes, target);
    return motor(std::move(bytes));
  }
  Write operator()(const Accelerate& c) const {
    Bytes bytes = {kAccelerate, c.speed, c.change};
    put16(bytes, c.turn_deg_s);
    for (const bool flag : {c.counter_clockwise, c.backwards, c.keep_turn}) bytes.push_back(flag);
    bytes.push_back(c.tens_of_ms);
    return motor(std::move(bytes));
  }
  Write operator()(const NotifyId& c) const {
    return setting({kNotifyId, 0, c.tens_of_ms, static_cast<std::uint8_t>(c.when)});
  }
  Write operator()(const NotifyIdMissed& c) const {
    return setting({kNotifyIdMissed, 0, c.tens_of_ms});
  }
  Write operator()(const NotifyWheelSpeeds& c) const {
    return setting({kNotifyWheelSpeeds, 0, static_cast<std::uint8_t>(c.on)});
  }
  Write operator()(const AskInterval& c) const {
    Bytes bytes = {kAskInterval, 0};
    put16(bytes, c.min);
    put16(bytes, c.max);
    return setting(std::move(bytes));
  }
  Write operator()(const AskVersion&) const { return setting({kAskVersion, 0}); }
  Write operator()(const LightOn& c) const {
    return {Characteristic::kLight, {kLightOn, c.tens_of_ms, 1, 1, c.red, c.green, c.blue}};
  }
  Write operator()(const LightOff&) const { return {Characteristic::kLight, {kLightOff}}; }

  static Write motor(Bytes bytes) { return {Characteristic::kMotor, std::move(bytes)}; }
  static Write setting(Bytes bytes) { return {Characteristic::kConfiguration, std::move(bytes)}; }
};

std::optional<CubeCommand> decode_targets(View bytes) {
  const bool many = bytes[0] == kGoThrough;
  const std::size_t header = many ? kListHeader : kListHeader - 1;
  if (bytes.size() < header + kTargetBytes) return std::nullopt;
  if ((bytes.size() - header) % kTargetBytes != 0) return std::nullopt;
  const std::size_t count = (bytes.size() - header) / kTargetBytes;
  if (count > (many ? kMaxTargets : 1) || (many && bytes[7] > 1)) return std::nullopt;

  const std::optional<TargetMode> mode = get_mode(bytes);
  if (!mode) return std::nullopt;
  std::vector<Target> targets;
  for (std::size_t i = 0; i < count; ++i) {
    const std::optional<Target> target = get_target(bytes, header + i * kTargetBytes);
    if (!target) return std::nullopt;
    targets.push_back(*target);
  }
  if (!many) return GoTo{*mode, targets.front()};
  return GoThrough{*mode, bytes[7] == 1, std::move(targets)};
}

std::optional<CubeCommand> decode_motor(View bytes) {
  switch (bytes[0]) {
    case kDriveOn:
    case kDriveFor: {
      const bool timed = bytes[0] == kDriveFor;
      if (bytes.size() != (timed ? 8 : 7)) return std::nullopt;
      const std::optional<WheelUnits> speed = get_wheels(bytes);
      if (!speed) return std::nullopt;
      if (timed) return DriveFor{*speed, bytes[7]};
      return DriveOn{*speed};
    }
    case kGoTo:
    case kGoThrough:
      return decode_targets(bytes);
    case kAccelerate:
      if (bytes.size() != 9 || bytes[5] > 1 || bytes[6] > 1 || bytes[7] > 1) return std::nullopt;
      return Accelerate{bytes[1],      bytes[2],      get16(bytes, 3), bytes[5] == 1,
                        bytes[6] == 1, bytes[7] == 1, bytes[8]};
    default:
      return std::nullopt;
  }
}

std::optional<CubeCommand> decode_setting(View bytes) {
  if (bytes.size() < 2) return std::nullopt;
  switch (bytes[0]) {
    case kAskVersion:
      return bytes.size() == 2 ? std::optional<CubeCommand>(AskVersion{}) : std::nullopt;
    case kNotifyId:
      if (bytes.size() != 4) return std::nullopt;
      if (bytes[3] != 0x00 && bytes[3] != 0x01 && bytes[3] != 0xff) return std::nullopt;
      return NotifyId{bytes[2], static_cast<NotifyWhen>(bytes[3])};
    case kNotifyIdMissed:
      return bytes.size() == 3 ? std::optional<CubeCommand>(NotifyIdMissed{bytes[2]})
                               : std::nullopt;
    case kNotifyWheelSpeeds:
      if (bytes.size() != 3 || bytes[2] > 1) return std::nullopt;
      return NotifyWheelSpeeds{bytes[2] == 1};
    case kAskInterval:
      if (bytes.size() != 6) return std::nullopt;
      return AskInterval{get16(bytes, 2), get16(bytes, 4)};
    default:
      return std::nullopt;
  }
}

std::optional<CubeCommand> decode_light(View bytes) {
  if (bytes.size() == 1 && bytes[0] == kLightOff) return LightOff{};
  if (bytes.size() != 7 || bytes[0] != kLightOn || bytes[2] != 1 || bytes[3] != 1) {
    return std::nullopt;
  }
  return LightOn{bytes[1], bytes[4], bytes[5], bytes[6]};
}

}  // namespace

Write encode(const CubeCommand& command) { return std::visit(CommandEncoder{}, command); }

std::optional<CubeCommand> decode_command(Characteristic to, View bytes) {
  if (bytes.empty()) return std::nullopt;
  switch (to) {
    case Characteristic::kMotor:
      return decode_motor(bytes);
    case Characteristic::kConfiguration:
      return decode_setting(bytes);
    case Characteristic::kLight:
      return decode_light(bytes);
    default:
      return std::nullopt;
  }
}

}  // namespace mvtp
