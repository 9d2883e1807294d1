#include "tools/toio/cube/protocol.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace mvtp {
namespace {

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

std::string to_hex(std::span<const std::uint8_t> bytes) {
  return fmt::format("{:02x}", fmt::join(bytes, " "));
}

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
