#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "planner/problem/input_error.hpp"
#include "tools/cli/suggest.hpp"

namespace mvtp {

/// Reads options as a command does, "--seed=3", so that Python's have the same names, limits and
/// messages. @param declare  declares them on a CLI::App
/// @throws InputError with the line that the command would print
template <class Declare>
void parse_words(const std::string& command, std::vector<std::string> words,
                 const Declare& declare) {
  CLI::App app;
  declare(app);
  std::ranges::reverse(words);  // as CLI11 wants them
  try {
    app.parse(std::move(words));
  } catch (const CLI::ParseError& error) {
    std::string problem = stray_word(app);
    if (problem.empty()) problem = std::string(error.what()) + "; ";
    throw InputError(command, problem + "see mvtp " + command + " --help");
  }
}

}  // namespace mvtp
