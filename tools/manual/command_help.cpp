#include "tools/manual/command_help.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "planner/problem/input_error.hpp"

namespace mvtp {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(OptionHelp, names, positional, value, description, default_value,
                                   group, required, repeated)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CommandHelp, name, summary, footer, options, commands)

namespace {

/// CLI11 writes a choice as "TEXT:{a,b}".
std::string value_of(const CLI::Option& option) {
  if (option.get_type_size_max() == 0 || option.get_items_expected_max() == 0) return "";
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{');
  if (open == std::string::npos) return type;
  std::string words = type.substr(open + 1, type.find('}') - open - 1);
  std::ranges::replace(words, ',', '|');
  return words;
}

OptionHelp help_of(const CLI::Option& option) {
  OptionHelp help;
  for (const std::string& name : option.get_snames()) help.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) help.names.push_back("--" + name);
  help.positional = !option.nonpositional();
  if (help.positional) help.names = {option.get_name(true)};
  help.value = value_of(option);
  help.description = option.get_description();
  help.default_value = option.get_default_str();
  help.group = option.get_group();
  help.required = option.get_required();
  help.repeated = option.get_items_expected_max() > 1;
  return help;
}

CommandHelp* find(std::vector<CommandHelp>& commands, const std::string& name) {
  const auto found = std::ranges::find(commands, name, &CommandHelp::name);
  return found == commands.end() ? nullptr : &*found;
}

/// Only --help is declared for everyone.
bool is_bare(const CommandHelp& command) {
  return command.options.size() <= 1 && command.commands.empty() && command.footer.empty();
}

}  // namespace

CommandHelp help_of(const CLI::App& app) {
  CommandHelp help;
  for (const CLI::App* a = &app; a != nullptr; a = a->get_parent()) {
    help.name = a->get_name() + (help.name.empty() ? "" : " " + help.name);
  }
  help.summary = app.get_description();
  help.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_group().empty()) help.options.push_back(help_of(*option));
  }
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (!command->get_group().empty()) help.commands.push_back(help_of(*command));
  }
  return help;
}

std::vector<std::string> choices_of(const OptionHelp& option) {
  const char separator = option.value.find('|') == std::string::npos ? ',' : '|';
  const bool is_choice = option.value.find(separator) != std::string::npos &&
                         option.value.find("...") == std::string::npos;
  return is_choice ? CLI::detail::split(option.value, separator) : std::vector<std::string>{};
}

std::string to_json(const CommandHelp& help) { return nlohmann::json(help).dump(1); }

CommandHelp help_of_json(const std::string& json, const std::string& where) {
  try {
    return nlohmann::json::parse(json).get<CommandHelp>();
  } catch (const nlohmann::json::exception& error) {
    throw InputError(where, std::string("describes no program: ") + error.what());
  }
}

std::vector<CommandHelp> merge_programs(const std::vector<CommandHelp>& programs) {
  std::vector<CommandHelp> merged;
  for (const CommandHelp& program : programs) {
    CommandHelp* same = find(merged, program.name);
    if (same == nullptr) {
      merged.push_back(program);
      continue;
    }
    for (const CommandHelp& command : program.commands) {
      CommandHelp* known = find(same->commands, command.name);
      if (known == nullptr) {
        same->commands.push_back(command);
      } else if (is_bare(*known)) {
        *known = command;
      }
    }
  }
  return merged;
}

}  // namespace mvtp
