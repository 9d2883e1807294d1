#include "tools/toio/protocol.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

namespace mvtp {
namespace {

using View = std::span<const std::uint8_t>;

// Type bytes of the frames.
constexpr std::uint8_t kDriveOn = 0x01;
constexpr std::uint8_t kDriveFor = 0x02;
constexpr std::uint8_t kGoTo = 0x03;
constexpr std::uint8_t kGoThrough = 0x04;
constexpr std::uint8_t kAccelerate = 0x05;
constexpr std::uint8_t kAskVersion = 0x01;
constexpr std::uint8_t kNotifyId = 0x18;
constexpr std::uint8_t kNotifyIdMissed = 0x19;
constexpr std::uint8_t kNotifyWheelSpeeds = 0x1c;
constexpr std::uint8_t kAskInterval = 0x30;
constexpr std::uint8_t kLightOff = 0x01;
constexpr std::uint8_t kLightOn = 0x03;
constexpr std::uint8_t kAnswer = 0x80;  // added to the type of what is answered
constexpr std::uint8_t kWheelSpeeds = 0xe0;

// Lengths of the frames.
constexpr std::size_t kTargetBytes = 6;
constexpr std::size_t kListHeader = 8;

constexpr std::uint8_t kLeft = 1;
constexpr std::uint8_t kRight = 2;
constexpr std::uint8_t kForward = 1;
constexpr std::uint8_t kBackward = 2;

void put16(Bytes& bytes, unsigned value) {
  bytes.push_back(static_cast<std::uint8_t>(value & 0xffU));
  bytes.push_back(static_cast<std::uint8_t>(value >> 8U));
}

std::uint16_t get16(View bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | (bytes[at + 1] << 8U));
}

void put_wheel(Bytes& bytes, std::uint8_t wheel, int speed) {
  bytes.push_back(wheel);
  bytes.push_back(speed < 0 ? kBackward : kForward);
  bytes.push_back(static_cast<std::uint8_t>(std::min(std::abs(speed), 255)));
}

Bytes wheel_bytes(std::uint8_t type, const WheelUnits& speed) {
  Bytes bytes = {type};
  put_wheel(bytes, kLeft, speed.left);
  put_wheel(bytes, kRight, speed.right);
  return bytes;
}

/// Reads the two wheels, in either order, from bytes 1 to 6.
std::optional<WheelUnits> get_wheels(View bytes) {
  WheelUnits units;
  if (bytes[1] == bytes[4]) return std::nullopt;
  for (const std::size_t at : {1, 4}) {
    const std::uint8_t wheel = bytes[at];
    const std::uint8_t direction = bytes[at + 1];
    if (wheel != kLeft && wheel != kRight) return std::nullopt;
    if (direction != kForward && direction != kBackward) return std::nullopt;
    const int speed = direction == kBackward ? -int(bytes[at + 2]) : int(bytes[at + 2]);
    (wheel == kLeft ? units.left : units.right) = speed;
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

/// Turns an event into a notification.
struct EventEncoder {
  Notification operator()(const PositionId& e) const {
    Bytes bytes = {0x01};
    for (const unsigned value : {e.x, e.y, e.degrees, e.sensor_x, e.sensor_y, e.sensor_degrees}) {
      put16(bytes, value);
    }
    return {Characteristic::kId, std::move(bytes)};
  }
  Notification operator()(const StandardId& e) const {
    Bytes bytes = {0x02};
    put16(bytes, e.value & 0xffffU);
    put16(bytes, e.value >> 16U);
    put16(bytes, e.degrees);
    return {Characteristic::kId, std::move(bytes)};
  }
  Notification operator()(const PositionMissed&) const { return {Characteristic::kId, {0x03}}; }
  Notification operator()(const StandardMissed&) const { return {Characteristic::kId, {0x04}}; }
  Notification operator()(const TargetDone& e) const {
    return {Characteristic::kMotor,
            {static_cast<std::uint8_t>(kAnswer + (e.many ? kGoThrough : kGoTo)), e.id,
             static_cast<std::uint8_t>(e.result)}};
  }
  Notification operator()(const WheelSpeeds& e) const {
    return {Characteristic::kMotor, {kWheelSpeeds, e.left, e.right}};
  }
  Notification operator()(const Button& e) const {
    return {Characteristic::kButton, {0x01, static_cast<std::uint8_t>(e.pressed ? 0x80 : 0x00)}};
  }
  Notification operator()(const Battery& e) const {
    return {Characteristic::kBattery, {e.percent}};
  }
  Notification operator()(const Motion& e) const {
    return {Characteristic::kSensor, {0x01, e.flat, e.collision, e.double_tap, e.posture, e.shake}};
  }
  Notification operator()(const Version& e) const {
    Bytes bytes = {kAnswer + kAskVersion, 0};
    bytes.insert(bytes.end(), e.text.begin(), e.text.end());
    return {Characteristic::kConfiguration, std::move(bytes)};
  }
  Notification operator()(const SettingDone& e) const {
    return {Characteristic::kConfiguration, {e.setting, 0, e.result}};
  }
};

std::optional<CubeEvent> decode_id(View bytes) {
  switch (bytes[0]) {
    case 0x01:
      if (bytes.size() != 13 || get16(bytes, 5) > 360 || get16(bytes, 11) > 360) {
        return std::nullopt;
      }
      return PositionId{get16(bytes, 1), get16(bytes, 3), get16(bytes, 5),
                        get16(bytes, 7), get16(bytes, 9), get16(bytes, 11)};
    case 0x02:
      if (bytes.size() != 7 || get16(bytes, 5) > 360) return std::nullopt;
      return StandardId{get16(bytes, 1) | (std::uint32_t(get16(bytes, 3)) << 16U), get16(bytes, 5)};
    case 0x03:
      return bytes.size() == 1 ? std::optional<CubeEvent>(PositionMissed{}) : std::nullopt;
    case 0x04:
      return bytes.size() == 1 ? std::optional<CubeEvent>(StandardMissed{}) : std::nullopt;
    default:
      return std::nullopt;
  }
}

std::optional<CubeEvent> decode_motor_event(View bytes) {
  if (bytes.size() != 3) return std::nullopt;
  if (bytes[0] == kWheelSpeeds) return WheelSpeeds{bytes[1], bytes[2]};
  const bool many = bytes[0] == kAnswer + kGoThrough;
  if ((!many && bytes[0] != kAnswer + kGoTo) || bytes[2] > 7) return std::nullopt;
  return TargetDone{many, bytes[1], static_cast<TargetResult>(bytes[2])};
}

std::optional<CubeEvent> decode_setting_event(View bytes) {
  if (bytes.size() < 3 || bytes[0] < kAnswer) return std::nullopt;
  if (bytes[0] != kAnswer + kAskVersion) {
    return bytes.size() == 3 ? std::optional<CubeEvent>(SettingDone{bytes[0], bytes[2]})
                             : std::nullopt;
  }
  Version version;
  for (const std::uint8_t byte : bytes.subspan(2)) {
    if (byte < 0x20 || byte > 0x7e) return std::nullopt;
    version.text += static_cast<char>(byte);
  }
  return version;
}

std::optional<CubeEvent> decode_motion(View bytes) {
  if (bytes.size() != 6 || bytes[0] != 0x01) return std::nullopt;
  return Motion{bytes[1] != 0, bytes[2] != 0, bytes[3] != 0, bytes[4], bytes[5]};
}

/// What tells the UUIDs of the characteristics apart: their fourth byte.
std::string_view uuid_part(Characteristic characteristic) {
  switch (characteristic) {
    case Characteristic::kId:
      return "01";
    case Characteristic::kMotor:
      return "02";
    case Characteristic::kLight:
      return "03";
    case Characteristic::kSound:
      return "04";
    case Characteristic::kSensor:
      return "06";
    case Characteristic::kButton:
      return "07";
    case Characteristic::kBattery:
      return "08";
    case Characteristic::kConfiguration:
      return "ff";
  }
  return "";
}

}  // namespace

std::string uuid(Characteristic characteristic) {
  return std::string(kServiceUuid).replace(6, 2, uuid_part(characteristic));
}

std::optional<Characteristic> characteristic_of(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(),
                         [](char c) { return c >= 'A' && c <= 'F' ? char(c - 'A' + 'a') : c; });
  for (const Characteristic characteristic : kCharacteristics) {
    if (lower == uuid(characteristic)) return characteristic;
  }
  return std::nullopt;
}

const char* to_string(Characteristic characteristic) {
  switch (characteristic) {
    case Characteristic::kId:
      return "id";
    case Characteristic::kMotor:
      return "motor";
    case Characteristic::kLight:
      return "light";
    case Characteristic::kSound:
      return "sound";
    case Characteristic::kSensor:
      return "sensor";
    case Characteristic::kButton:
      return "button";
    case Characteristic::kBattery:
      return "battery";
    case Characteristic::kConfiguration:
      return "configuration";
  }
  return "";
}

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

Notification encode(const CubeEvent& event) { return std::visit(EventEncoder{}, event); }

std::optional<CubeEvent> decode_event(Characteristic from, View bytes) {
  if (bytes.empty()) return std::nullopt;
  switch (from) {
    case Characteristic::kId:
      return decode_id(bytes);
    case Characteristic::kMotor:
      return decode_motor_event(bytes);
    case Characteristic::kConfiguration:
      return decode_setting_event(bytes);
    case Characteristic::kSensor:
      return decode_motion(bytes);
    case Characteristic::kButton:
      if (bytes.size() != 2 || bytes[0] != 0x01) return std::nullopt;
      return Button{bytes[1] != 0};
    case Characteristic::kBattery:
      return bytes.size() == 1 && bytes[0] <= 100 ? std::optional<CubeEvent>(Battery{bytes[0]})
                                                  : std::nullopt;
    default:
      return std::nullopt;
  }
}

std::string to_hex(View bytes) { return fmt::format("{:02x}", fmt::join(bytes, " ")); }

std::optional<Bytes> from_hex(std::string_view text) {
  const auto digit = [](char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
  };
  Bytes bytes;
  for (std::size_t i = 0; i < text.size(); i += 3) {
    if (i + 1 >= text.size() || (i + 2 < text.size() && text[i + 2] != ' ')) return std::nullopt;
    if (i + 2 == text.size() - 1) return std::nullopt;  // a blank at the end
    const int high = digit(text[i]);
    const int low = digit(text[i + 1]);
    if (high < 0 || low < 0) return std::nullopt;
    bytes.push_back(static_cast<std::uint8_t>(high * 16 + low));
  }
  return bytes;
}

}  // namespace mvtp
