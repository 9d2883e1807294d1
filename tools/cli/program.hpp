#pragma once

#include <functional>
#include <span>

namespace CLI {
class App;
}

namespace mvtp {

/// Exit codes of every command.
enum ExitCode : int {
  kDone = 0,
  kNotAchieved = 1,  ///< the job ran but did not succeed: not solved, plan invalid
  kBadInput = 2,     ///< bad input or usage
  kInterrupted = 130,
};

/// What a command does once its options are read; returns the exit code.
using Action = std::function<int()>;

/// One sub-command of a program.
struct Command {
  const char* name;
  const char* summary;  ///< one line for the list of commands
  /// Declares the options on the sub-command's own `app` and returns what runs once they are
  /// parsed. nullptr: the command lives in the sibling executable (see sibling.hpp) and parses its
  /// own.
  Action (*declare)(CLI::App& app);
};

/// Is this "PROGRAM describe"? Programs answer with all their options as JSON (tools/manual/), out
/// of which manual pages and completion are made.
[[nodiscard]] bool asks_for_description(int argc, char** argv);

/// Parses the command line, runs the chosen command and returns its exit code.
///
/// What goes wrong is told in one line on stderr, "mvtp: ...": bad usage and InputError give
/// kBadInput, any other exception kNotAchieved.
[[nodiscard]] int run_program(int argc, char** argv, std::span<const Command> commands);

}  // namespace mvtp
