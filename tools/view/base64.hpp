#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace mvtp {

/// Bytes as text in the alphabet of RFC 4648, filled up with '='.
[[nodiscard]] std::string to_base64(std::string_view bytes);
/// nullopt if the text is not of that alphabet.
[[nodiscard]] std::optional<std::string> from_base64(std::string_view text);

}  // namespace mvtp
