#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "tools/toio/cube/protocol.hpp"

/// What the frames of commands and of events are made of: their type bytes, and numbers of two
/// bytes.
namespace mvtp {

using View = std::span<const std::uint8_t>;

inline constexpr std::uint8_t kDriveOn = 0x01;
inline constexpr std::uint8_t kDriveFor = 0x02;
inline constexpr std::uint8_t kGoTo = 0x03;
inline constexpr std::uint8_t kGoThrough = 0x04;
inline constexpr std::uint8_t kAccelerate = 0x05;
inline constexpr std::uint8_t kAskVersion = 0x01;
inline constexpr std::uint8_t kNotifyId = 0x18;
inline constexpr std::uint8_t kNotifyIdMissed = 0x19;
inline constexpr std::uint8_t kNotifyWheelSpeeds = 0x1c;
inline constexpr std::uint8_t kAskInterval = 0x30;
inline constexpr std::uint8_t kLightOff = 0x01;
inline constexpr std::uint8_t kLightOn = 0x03;
inline constexpr std::uint8_t kAnswer = 0x80;  // added to the type of what is answered
inline constexpr std::uint8_t kWheelSpeeds = 0xe0;

inline void put16(Bytes& bytes, unsigned value) {
  bytes.push_back(static_cast<std::uint8_t>(value & 0xffU));
  bytes.push_back(static_cast<std::uint8_t>(value >> 8U));
}

[[nodiscard]] inline std::uint16_t get16(View bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | (bytes[at + 1] << 8U));
}

}  // namespace mvtp
