#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tools/suggest.hpp"

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

/// Declares an option that takes whole numbers from `low` to `high` with commas between, "5,10".
inline CLI::Option* add_numbers(CLI::App& app, const std::string& name, std::vector<int>& target,
                                int low, int high, const std::string& description) {
  const auto split = [](const std::string& text) { return CLI::detail::split(text, ','); };
  return app
      .add_option_function<std::string>(
          name,
          [&target, split](const std::string& text) {
            target.clear();
            for (const std::string& word : split(text)) target.push_back(std::stoi(word));
          },
          description)
      ->check([split, is_valid = whole_number_between(low, high)](const std::string& text) {
        for (const std::string& word : split(text)) {
          if (std::string problem = is_valid(word); !problem.empty()) return problem;
        }
        return std::string();
      })
      ->type_name("N,N,...");
}

/// For CLI::Option::check(): one of these words.
[[nodiscard]] inline auto one_of(std::vector<std::string> words) {
  return [words = std::move(words)](const std::string& word) -> std::string {
    if (std::find(words.begin(), words.end(), word) != words.end()) return "";
    return "is \"" + word + "\"; " + did_you_mean(word, words) + "choose " +
           CLI::detail::join(words, "|");
  };
}

/// Declares an option that takes one of a few words, each standing for a value.
template <class Value, class Target>
CLI::Option* add_choice(CLI::App& app, const std::string& name, Target& target,
                        const std::map<std::string, Value>& words, const std::string& description) {
  std::vector<std::string> choices;
  for (const auto& [word, value] : words) choices.push_back(word);
  return app
      .add_option_function<std::string>(
          name, [&target, words](const std::string& word) { target = words.at(word); }, description)
      ->check(one_of(choices))
      ->type_name(CLI::detail::join(choices, "|"));
}

}  // namespace mvtp
