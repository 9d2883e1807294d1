#include "tools/manual/man_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <sstream>

namespace mvtp {
namespace {

/// Text that troff prints as it is, whatever a line begins with.
std::string plain(const std::string& text) {
  std::string line;
  for (const char c : text) {
    if (c == '\\') {
      line += "\\e";
    } else if (c == '-') {
      line += "\\-";
    } else {
      line += c;
    }
  }
  return !line.empty() && (line[0] == '.' || line[0] == '\'') ? "\\&" + line : line;
}

std::string bold(const std::string& text) { return "\\fB" + plain(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + plain(text) + "\\fR"; }

/// A paragraph; indented lines are examples, and stay as they are.
std::string paragraph(const std::string& text) {
  std::string page;
  bool example = false;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const bool indented = line.starts_with("  ");
    if (indented != example) page += indented ? ".PP\n.EX\n" : ".EE\n.PP\n";
    example = indented;
    if (!line.empty()) page += plain(line) + "\n";
  }
  return page + (example ? ".EE\n" : "");
}

/// An option's description: each line of its text begins a line.
std::string described(const OptionHelp& option) {
  std::string page;
  std::istringstream lines(option.description);
  for (std::string line; std::getline(lines, line);) {
    page += (page.empty() ? "" : ".br\n") + plain(line) + "\n";
  }
  if (!option.default_value.empty()) {
    page += ".br\nDefault: " + plain(option.default_value) + "\n";
  }
  return page;
}

std::string tag(const OptionHelp& option) {
  std::string names;
  for (const std::string& name : option.names) names += (names.empty() ? "" : ", ") + bold(name);
  if (option.positional) names = italic(option.names.front());
  if (!option.positional && !option.value.empty()) names += ' ' + italic(option.value);
  return names + (option.repeated ? " ..." : "");
}

std::string synopsis(const CommandHelp& command) {
  std::string line = bold(command.name) + " [" + italic("options") + "]";
  for (const OptionHelp& option : command.options) {
    const bool named = !option.positional;
    if (named && !option.required) continue;
    std::string word = named ? bold(option.names.back()) + " " + italic(option.value)
                             : italic(option.names.front());
    if (option.repeated) word += " ...";
    line += ' ' + (option.required ? word : fmt::format("[{}]", word));
  }
  return line + (command.commands.empty() ? "" : " [" + italic("command") + " ...]") + "\n";
}

std::string options_section(const CommandHelp& command) {
  std::vector<std::string> groups;
  for (const OptionHelp& option : command.options) {
    if (std::ranges::find(groups, option.group) == groups.end()) groups.push_back(option.group);
  }
  std::string page = command.options.empty() ? "" : ".SH OPTIONS\n";
  for (const std::string& group : groups) {
    page += ".SS " + plain(group) + "\n";
    for (const OptionHelp& option : command.options) {
      if (option.group == group) page += ".TP\n" + tag(option) + "\n" + described(option);
    }
  }
  return page;
}

std::string commands_section(const CommandHelp& command) {
  std::string page = command.commands.empty() ? "" : ".SH COMMANDS\n";
  for (const CommandHelp& below : command.commands) {
    page += fmt::format(".TP\n{}(1)\n{}\n", bold(page_name(below.name)), plain(below.summary));
  }
  return page;
}

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace

std::string page_name(const std::string& command) {
  std::string name = command;
  std::ranges::replace(name, ' ', '-');
  return name;
}

std::string man_page(const CommandHelp& command, const CommandHelp* above,
                     const std::string& version) {
  const std::string name = page_name(command.name);
  std::string page =
      fmt::format(".TH {} 1 \"\" \"mvtp {}\" \"User Commands\"\n", upper(name), version);
  page += fmt::format(".SH NAME\n{} \\- {}\n", plain(name), plain(command.summary));
  page += ".SH SYNOPSIS\n" + synopsis(command);
  if (!command.footer.empty()) page += ".SH DESCRIPTION\n" + paragraph(command.footer);
  page += commands_section(command) + options_section(command);
  page +=
      ".SH EXIT STATUS\n0 done; 1 the job ran but did not succeed; 2 bad input or usage; "
      "130 interrupted.\n";
  if (above != nullptr) page += ".SH SEE ALSO\n" + bold(page_name(above->name)) + "(1)\n";
  return page;
}

}  // namespace mvtp
