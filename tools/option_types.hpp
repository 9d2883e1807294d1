#pragma once

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>
#include <string>

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

/// Declares an option that takes one of a few words, each standing for a value.
template <class Value, class Target>
CLI::Option* add_choice(CLI::App& app, const std::string& name, Target& target,
                        const std::map<std::string, Value>& words, const std::string& description) {
  std::string type;
  for (const auto& [word, value] : words) type += (type.empty() ? "" : "|") + word;
  return app
      .add_option_function<std::string>(
          name, [&target, words](const std::string& word) { target = words.at(word); }, description)
      ->check([words, type](const std::string& word) {
        return words.contains(word) ? "" : "is \"" + word + "\"; choose " + type;
      })
      ->type_name(type);
}

}  // namespace mvtp
