#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// The frames that a toio Core Cube understands and sends, byte for byte.
///
/// Source: toio Core Cube Specification 2.5.0, https://toio.github.io/toio-spec/ (ble_motor,
/// ble_id, ble_configuration, ble_light, ble_button, ble_battery, ble_sensor). Numbers of several
/// bytes are little-endian; positions are in dots of the mat, x right and y down; angles in whole
/// degrees, clockwise from +x.
namespace mvtp {

using Bytes = std::vector<std::uint8_t>;

/// The characteristics of a cube's one service.
enum class Characteristic : std::uint8_t {
  kId,
  kMotor,
  kLight,
  kSound,
  kSensor,
  kButton,
  kBattery,
  kConfiguration,
};
inline constexpr std::array kCharacteristics = {
    Characteristic::kId,      Characteristic::kMotor,        Characteristic::kLight,
    Characteristic::kSound,   Characteristic::kSensor,       Characteristic::kButton,
    Characteristic::kBattery, Characteristic::kConfiguration};

/// The UUID of a cube's service, by which it is found, in lower case as BlueZ writes it.
inline constexpr std::string_view kServiceUuid = "10b20100-5b3b-4571-9508-cf3efcd7bbae";
[[nodiscard]] std::string uuid(Characteristic characteristic);
/// Upper or lower case; nullopt for UUIDs that are none of a cube's.
[[nodiscard]] std::optional<Characteristic> characteristic_of(std::string_view uuid);
/// A short name: "motor".
[[nodiscard]] const char* to_string(Characteristic characteristic);

// What is written to a cube -------------------------------------------------------------------

/// Speeds of the two wheels in the cube's units, -255 ... 255, negative: backwards.
struct WheelUnits {
  int left = 0;
  int right = 0;
  friend bool operator==(const WheelUnits&, const WheelUnits&) = default;
};

/// 0x01: turn the wheels until the next command.
struct DriveOn {
  WheelUnits speed;
  friend bool operator==(const DriveOn&, const DriveOn&) = default;
};

/// 0x02: turn the wheels for a time.
struct DriveFor {
  WheelUnits speed;
  std::uint8_t tens_of_ms = 0;  ///< 0: without end
  friend bool operator==(const DriveFor&, const DriveFor&) = default;
};

/// How a cube moves to a target.
enum class TargetMovement : std::uint8_t { kCurve = 0, kCurveForward = 1, kTurnThenMove = 2 };
enum class SpeedChange : std::uint8_t { kConstant = 0, kFaster = 1, kSlower = 2, kBoth = 3 };
/// How the angle of a target is meant; it is turned to on the spot once x and y are reached.
enum class AngleRule : std::uint8_t {
  kShorter = 0,
  kClockwise = 1,
  kCounterClockwise = 2,
  kByClockwise = 3,
  kByCounterClockwise = 4,
  kAny = 5,   ///< no angle: stop on reaching x and y
  kKeep = 6,  ///< as at the write
};

/// "Where the cube is", for either coordinate of a target.
inline constexpr std::uint16_t kSamePlace = 0xffff;

struct Target {
  std::uint16_t x = kSamePlace;
  std::uint16_t y = kSamePlace;
  AngleRule rule = AngleRule::kAny;
  std::uint16_t degrees = 0;  ///< 13 bits
  friend bool operator==(const Target&, const Target&) = default;
};

/// What one and many targets have in common.
struct TargetMode {
  std::uint8_t id = 0;         ///< echoed in the response
  std::uint8_t timeout_s = 0;  ///< 0 means 10 s
  TargetMovement movement = TargetMovement::kCurve;
  std::uint8_t max_speed = 10;
  SpeedChange speed_change = SpeedChange::kConstant;
  friend bool operator==(const TargetMode&, const TargetMode&) = default;
};

/// 0x03: drive to one target.
struct GoTo {
  TargetMode mode;
  Target target;
  friend bool operator==(const GoTo&, const GoTo&) = default;
};

inline constexpr std::size_t kMaxTargets = 29;

/// 0x04: drive to 1 ... kMaxTargets targets, one after the other.
struct GoThrough {
  TargetMode mode;
  bool append = false;  ///< after what is being driven, instead of in its place
  std::vector<Target> targets;
  friend bool operator==(const GoThrough&, const GoThrough&) = default;
};

/// 0x05: drive with an acceleration.
struct Accelerate {
  std::uint8_t speed = 0;   ///< of the middle, in wheel units
  std::uint8_t change = 0;  ///< of that speed per 100 ms; 0: at once
  std::uint16_t turn_deg_s = 0;
  bool counter_clockwise = false;
  bool backwards = false;
  bool keep_turn = false;       ///< what is kept where a wheel would be too fast
  std::uint8_t tens_of_ms = 0;  ///< 0: without end
  friend bool operator==(const Accelerate&, const Accelerate&) = default;
};

/// When the position is notified: always, on a change, or until nothing changed for 300 ms.
enum class NotifyWhen : std::uint8_t { kAlways = 0x00, kOnChange = 0x01, kWhileChanging = 0xff };

struct NotifyId {
  std::uint8_t tens_of_ms = 1;
  NotifyWhen when = NotifyWhen::kWhileChanging;
  friend bool operator==(const NotifyId&, const NotifyId&) = default;
};
/// How long the mat must be unreadable before that is notified.
struct NotifyIdMissed {
  std::uint8_t tens_of_ms = 7;
  friend bool operator==(const NotifyIdMissed&, const NotifyIdMissed&) = default;
};
struct NotifyWheelSpeeds {
  bool on = false;
  friend bool operator==(const NotifyWheelSpeeds&, const NotifyWheelSpeeds&) = default;
};
/// The connection interval that the cube shall ask for, in units of 1.25 ms.
struct AskInterval {
  std::uint16_t min = 0xffff;
  std::uint16_t max = 0xffff;
  friend bool operator==(const AskInterval&, const AskInterval&) = default;
};
struct AskVersion {
  friend bool operator==(const AskVersion&, const AskVersion&) = default;
};
struct LightOn {
  std::uint8_t tens_of_ms = 0;  ///< 0: stays on
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
  friend bool operator==(const LightOn&, const LightOn&) = default;
};
struct LightOff {
  friend bool operator==(const LightOff&, const LightOff&) = default;
};

using CubeCommand =
    std::variant<DriveOn, DriveFor, GoTo, GoThrough, Accelerate, NotifyId, NotifyIdMissed,
                 NotifyWheelSpeeds, AskInterval, AskVersion, LightOn, LightOff>;

/// One write to a cube.
struct Write {
  Characteristic to = Characteristic::kMotor;
  Bytes bytes;
  friend bool operator==(const Write&, const Write&) = default;
};

/// @pre every field is in the range its comment gives.
[[nodiscard]] Write encode(const CubeCommand& command);
/// nullopt for what a cube would drop: an unknown type, a wrong length, a value out of range.
[[nodiscard]] std::optional<CubeCommand> decode_command(Characteristic to,
                                                        std::span<const std::uint8_t> bytes);

// What a cube notifies ------------------------------------------------------------------------

/// Where the cube's centre and its sensor are.
struct PositionId {
  std::uint16_t x = 0;
  std::uint16_t y = 0;
  std::uint16_t degrees = 0;  ///< 0 ... 360
  std::uint16_t sensor_x = 0;
  std::uint16_t sensor_y = 0;
  std::uint16_t sensor_degrees = 0;
  friend bool operator==(const PositionId&, const PositionId&) = default;
};
struct StandardId {
  std::uint32_t value = 0;
  std::uint16_t degrees = 0;
  friend bool operator==(const StandardId&, const StandardId&) = default;
};
struct PositionMissed {
  friend bool operator==(const PositionMissed&, const PositionMissed&) = default;
};
struct StandardMissed {
  friend bool operator==(const StandardMissed&, const StandardMissed&) = default;
};

enum class TargetResult : std::uint8_t {
  kReached = 0,
  kTimeout = 1,
  kMissed = 2,
  kNothingToDo = 3,
  kSwitchedOff = 4,
  kOverwritten = 5,
  kTooSlow = 6,
  kCannotAppend = 7,
};

/// The end of a GoTo (0x83) or GoThrough (0x84).
struct TargetDone {
  bool many = false;
  std::uint8_t id = 0;
  TargetResult result = TargetResult::kReached;
  friend bool operator==(const TargetDone&, const TargetDone&) = default;
};
/// Without sign.
struct WheelSpeeds {
  std::uint8_t left = 0;
  std::uint8_t right = 0;
  friend bool operator==(const WheelSpeeds&, const WheelSpeeds&) = default;
};
struct Button {
  bool pressed = false;
  friend bool operator==(const Button&, const Button&) = default;
};
struct Battery {
  std::uint8_t percent = 0;
  friend bool operator==(const Battery&, const Battery&) = default;
};
struct Motion {
  bool flat = true;
  bool collision = false;
  bool double_tap = false;
  std::uint8_t posture = 1;
  std::uint8_t shake = 0;
  friend bool operator==(const Motion&, const Motion&) = default;
};
/// "2.4.0".
struct Version {
  std::string text;
  friend bool operator==(const Version&, const Version&) = default;
};
/// The answer to a setting; `setting` is the type byte of the answer (0x98 for NotifyId, ...).
struct SettingDone {
  std::uint8_t setting = 0;
  std::uint8_t result = 0;  ///< 0: done
  friend bool operator==(const SettingDone&, const SettingDone&) = default;
};

using CubeEvent = std::variant<PositionId, StandardId, PositionMissed, StandardMissed, TargetDone,
                               WheelSpeeds, Button, Battery, Motion, Version, SettingDone>;

/// A value as a characteristic shows it.
struct Notification {
  Characteristic from = Characteristic::kId;
  Bytes bytes;
  friend bool operator==(const Notification&, const Notification&) = default;
};

[[nodiscard]] Notification encode(const CubeEvent& event);
/// nullopt for bytes that no cube would send, or that mean nothing to us.
[[nodiscard]] std::optional<CubeEvent> decode_event(Characteristic from,
                                                    std::span<const std::uint8_t> bytes);

/// "02 01 01 1e".
[[nodiscard]] std::string to_hex(std::span<const std::uint8_t> bytes);
/// nullopt unless `text` is pairs of hexadecimal digits with single blanks between.
[[nodiscard]] std::optional<Bytes> from_hex(std::string_view text);

}  // namespace mvtp
