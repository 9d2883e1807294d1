#include "tools/manual/markdown_page.hpp"

#include <algorithm>
#include <vector>

namespace mvtp {
namespace {

/// Text within one line of a table, in which nothing is markup.
std::string cell(const std::string& text) {
  std::string line;
  for (const char c : text) {
    if (c == '\n') {
      line += "<br>";
    } else if (c == '<') {
      line += "&lt;";
    } else if (c == '|') {
      line += "&#124;";
    } else {
      if (c == '*' || c == '_' || c == '[' || c == '\\' || c == '`') line += '\\';
      line += c;
    }
  }
  return line;
}

std::string code(const std::string& text) { return "<code>" + cell(text) + "</code>"; }

std::string names_of(const OptionHelp& option) {
  std::string names;
  for (const std::string& name : option.names) names += (names.empty() ? "" : ", ") + code(name);
  if (!option.positional && !option.value.empty()) names += ' ' + code(option.value);
  return names + (option.repeated ? " ..." : "");
}

std::string row(const OptionHelp& option) {
  std::string meaning = cell(option.description);
  if (!option.default_value.empty()) meaning += " \\[" + cell(option.default_value) + "]";
  if (option.required) meaning += " (required)";
  return "| " + names_of(option) + " | " + meaning + " |\n";
}

std::string option_tables(const CommandHelp& command) {
  std::vector<std::string> groups;
  for (const OptionHelp& option : command.options) {
    if (std::ranges::find(groups, option.group) == groups.end()) groups.push_back(option.group);
  }
  std::string page;
  for (const std::string& group : groups) {
    page += "| " + cell(group) + " | |\n|---|---|\n";
    for (const OptionHelp& option : command.options) {
      if (option.group == group) page += row(option);
    }
    page += "\n";
  }
  return page;
}

std::string section(const CommandHelp& command) {
  std::string page = "## " + command.name + "\n" + cell(command.summary) + ".\n\n";
  if (!command.footer.empty()) page += "```text\n" + command.footer + "\n```\n\n";
  page += option_tables(command);
  for (const CommandHelp& below : command.commands) page += section(below);
  return page;
}

}  // namespace

std::string markdown_reference(const CommandHelp& program) { return section(program); }

}  // namespace mvtp
