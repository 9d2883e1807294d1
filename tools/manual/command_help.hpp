#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace mvtp {

/// One option or positional argument of a command.
struct OptionHelp {
  std::vector<std::string> names;  ///< "-o", "--output"; of a positional its one name
  bool positional = false;
  std::string value;          ///< what follows it, "FILE" or "any|forward|reverse"; empty: a flag
  std::string description;    ///< may have several lines
  std::string default_value;  ///< empty if the description tells it, or there is none
  std::string group;
  bool required = false;
  bool repeated = false;  ///< takes more than one value

  bool operator==(const OptionHelp&) const = default;
};

/// What a program or one of its commands tells about itself: the source of the manual pages and of
/// the shells' completion.
struct CommandHelp {
  std::string name;  ///< with those above it: "mvtp toio fit"
  std::string summary;
  std::string footer;
  std::vector<OptionHelp> options;
  std::vector<CommandHelp> commands;

  bool operator==(const CommandHelp&) const = default;
};

/// Everything that was declared on `app`, commands below it included; what is hidden is left out.
[[nodiscard]] CommandHelp help_of(const CLI::App& app);

/// The words that an option takes, if its value is a choice: "any|forward" gives any and forward.
[[nodiscard]] std::vector<std::string> choices_of(const OptionHelp& option);

[[nodiscard]] std::string to_json(const CommandHelp& help);
/// @throws InputError if `json` is no such text; `where` names it.
[[nodiscard]] CommandHelp help_of_json(const std::string& json, const std::string& where);

/// One description out of those of several programs. Programs of one name become one: a command
/// that says nothing of itself in one is taken from the other.
[[nodiscard]] std::vector<CommandHelp> merge_programs(const std::vector<CommandHelp>& programs);

}  // namespace mvtp
