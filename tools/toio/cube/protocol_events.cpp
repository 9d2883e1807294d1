// What a cube notifies, to and from bytes.

#include <utility>

#include "tools/toio/cube/protocol.hpp"
#include "tools/toio/cube/protocol_bytes.hpp"

namespace mvtp {
namespace {

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

}  // namespace

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

}  // namespace mvtp
