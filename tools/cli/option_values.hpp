#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <system_error>

namespace mvtp {

/// For CLI::Option::check(): a finite number > 0. (CLI11's own lets infinity and NaN pass.)
[[nodiscard]] inline std::string positive_number(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = error == std::errc() && end == text.data() + text.size();
  if (is_number && std::isfinite(value) && value > 0.0) return "";
  return "is \"" + text + "\"; give a finite number > 0";
}

/// For CLI::Option::check(): a number from `low` to `high`. (CLI11's own lets NaN pass.)
[[nodiscard]] inline auto number_between(double low, double high) {
  return [low, high](const std::string& text) -> std::string {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool is_number = error == std::errc() && end == text.data() + text.size();
    if (is_number && value >= low && value <= high) return "";
    std::ostringstream message;
    message << "is \"" << text << "\"; give a number from " << low << " to " << high;
    return message.str();
  };
}

/// For CLI::Option::check(): a whole number from `low` to `high`, in digits alone.
[[nodiscard]] inline auto whole_number_between(std::int64_t low, std::int64_t high) {
  return [low, high](const std::string& text) -> std::string {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool is_number = error == std::errc() && end == text.data() + text.size();
    if (is_number && value >= low && value <= high) return "";
    return "is \"" + text + "\"; give a whole number from " + std::to_string(low) + " to " +
           std::to_string(high);
  };
}

}  // namespace mvtp
