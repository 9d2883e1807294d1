#include "tools/cli/program.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "planner/problem/input_error.hpp"
#include "tools/cli/child_process.hpp"
#include "tools/cli/interrupt.hpp"
#include "tools/cli/sibling.hpp"
#include "tools/cli/suggest.hpp"
#include "tools/cli/version.hpp"
#include "tools/manual/command_help.hpp"

namespace mvtp {
namespace {

/// One line, whatever the message holds.
void print_error(std::string message) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  while (!message.empty() && message.back() == ' ') message.pop_back();
  std::fputs(("mvtp: " + message + "\n").c_str(), stderr);  // fmt's throws if stderr is closed
}

/// The command that was chosen last: of "mvtp toio fit" that is fit.
const CLI::App& chosen_command(const CLI::App& app) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  return chosen.empty() ? app : chosen_command(*chosen.front());
}

/// Help and version are exceptions in CLI11's eyes, and no errors in ours.
int finish_parsing(const CLI::App& app, const CLI::ParseError& error) {
  if (dynamic_cast<const CLI::CallForVersion*>(&error) != nullptr) {
    fmt::print("{}\n", error.what());
    return kDone;
  }
  if (error.get_exit_code() == 0) {
    fmt::print("{}", app.help());
    return kDone;
  }
  const auto chosen = app.get_subcommands();
  const std::string command = chosen.empty() ? "" : " " + chosen.front()->get_name();
  std::string problem = stray_word(chosen_command(app));
  if (problem.empty()) problem = std::string(error.what()) + "; ";
  print_error(fmt::format("{}{}see mvtp{} --help", command.empty() ? "" : command.substr(1) + ": ",
                          problem, command));
  return kBadInput;
}

/// The words behind the program's name, the last one first, as CLI11 takes them. It would give an
/// option with nothing behind its '=' the next word.
std::vector<std::string> words_of(std::span<char* const> arguments) {
  std::vector<std::string> words;
  bool ours = true;  // what comes behind "--" is SUMO's
  for (const std::string_view word : arguments) {
    ours = ours && word != "--";
    const bool empty = ours && word.starts_with("--") && word.find('=') == word.size() - 1;
    words.emplace_back(empty ? word.substr(0, word.size() - 1) : word);
    if (empty) words.emplace_back();
  }
  std::ranges::reverse(words);
  return words;
}

const Command& find(std::span<const Command> commands, std::string_view name) {
  const auto found = std::find_if(commands.begin(), commands.end(),
                                  [&](const Command& command) { return command.name == name; });
  if (found == commands.end()) {
    std::vector<std::string> names;
    for (const Command& command : commands) names.emplace_back(command.name);
    throw InputError(
        std::string(name),
        "is no command of mvtp; " + did_you_mean(std::string(name), names) + "see mvtp --help");
  }
  return *found;
}

int print_description(const CLI::App& app) {
  fmt::print("{}\n", to_json(help_of(app)));
  return kDone;
}

/// Runs the command; what it printed must have arrived for it to count as done.
int run(const Action& action) {
  const int code = action();
  if (std::fflush(stdout) != 0) {
    throw InputError("standard output", "cannot be written; is the disk full?");
  }
  return code;
}

}  // namespace

bool asks_for_description(int argc, char** argv) {
  return argc == 2 && std::string_view(argv[1]) == "describe";
}

int run_program(int argc, char** argv, std::span<const Command> commands) {
  end_with_parent();
  end_on_signals();
  try {
    const bool describes = asks_for_description(argc, argv);
    if (!describes && argc > 1 && argv[1][0] != '-' && find(commands, argv[1]).declare == nullptr) {
      return run_sibling("mvtp-sumo", argc, argv);
    }

    CLI::App app("Coordinates many car-like vehicles: in SUMO, on benchmark maps, on robots",
                 "mvtp");
    app.set_version_flag("--version", version_text(),
                         "Print this program's and its libraries' versions");
    app.require_subcommand(1);
    std::vector<std::pair<CLI::App*, Action>> actions;
    for (const Command& command : commands) {
      CLI::App* sub = app.add_subcommand(command.name, command.summary);
      if (command.declare != nullptr) actions.emplace_back(sub, command.declare(*sub));
    }
    if (describes) return run([&] { return print_description(app); });
    try {
      app.parse(words_of(std::span(argv, std::size_t(argc)).subspan(1)));
    } catch (const CLI::ParseError& error) {
      return run([&] { return finish_parsing(app, error); });
    }
    for (const auto& [sub, action] : actions) {
      if (sub->parsed()) return run(action);
    }
    return kBadInput;
  } catch (const InputError& error) {
    print_error(error.what());
    return kBadInput;
  } catch (const std::bad_alloc&) {
    print_error("out of memory; give a smaller instance or more memory");
    return kNotAchieved;
  } catch (const std::exception& error) {
    print_error(fmt::format("internal error: {}", error.what()));
    return kNotAchieved;
  }
}

}  // namespace mvtp
