#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <string>

#include "tools/toio/cube/protocol.hpp"

namespace mvtp {

/// What decoding any bytes must do: nothing, or give a value that survives the path back and forth.
/// @return what broke that law, if anything did.
inline std::optional<std::string> broken_law(std::span<const std::uint8_t> bytes, int& understood) {
  for (const Characteristic characteristic : kCharacteristics) {
    if (const auto command = decode_command(characteristic, bytes)) {
      ++understood;
      const Write again = encode(*command);
      if (again.to != characteristic || decode_command(again.to, again.bytes) != command) {
        return "a command changed: " + to_hex(bytes);
      }
    }
    if (const auto event = decode_event(characteristic, bytes)) {
      ++understood;
      const Notification again = encode(*event);
      if (again.from != characteristic || decode_event(again.from, again.bytes) != event) {
        return "an event changed: " + to_hex(bytes);
      }
    }
  }
  const auto bytes_again = from_hex(to_hex(bytes));
  if (!bytes_again || !std::ranges::equal(*bytes_again, bytes)) return "text changed";
  return std::nullopt;
}

}  // namespace mvtp
