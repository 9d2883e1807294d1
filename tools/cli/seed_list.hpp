#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace mvtp {

/// Reads the option --seeds: "7", "1-5" or "1,2,7-9" into ascending seeds without repetition, at
/// most 1000.
/// @throws InputError
[[nodiscard]] std::vector<std::uint32_t> parse_seeds(const std::string& text);

}  // namespace mvtp
