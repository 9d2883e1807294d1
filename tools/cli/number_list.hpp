#pragma once

#include <string>
#include <vector>

namespace mvtp {

/// Reads a list of numbers: "0.5", "0,0.5,1", "0.5:2:0.25" (from, to, step; the end included).
/// @throws InputError for anything else, for numbers outside [low, high], and for more than 1000
[[nodiscard]] std::vector<double> parse_numbers(const std::string& option, const std::string& text,
                                                double low, double high);

}  // namespace mvtp
