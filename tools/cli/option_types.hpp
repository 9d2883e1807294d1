#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tools/cli/option_values.hpp"
#include "tools/cli/suggest.hpp"

namespace mvtp {

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
