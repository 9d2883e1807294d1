#include "tools/manual/completion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>

#include "tools/manual/man_page.hpp"

namespace mvtp {
namespace {

enum class ValueKind { kNone, kChoice, kFile, kFolder, kOther };

ValueKind kind_of(const OptionHelp& option) {
  if (!choices_of(option).empty()) return ValueKind::kChoice;
  if (option.value == "DIR") return ValueKind::kFolder;
  if (option.value == "FILE" || option.positional) return ValueKind::kFile;
  return option.value.empty() ? ValueKind::kNone : ValueKind::kOther;
}

bool has_positionals(const CommandHelp& command) {
  return std::ranges::any_of(command.options, &OptionHelp::positional);
}

/// The command and all below it, each before its own.
std::vector<const CommandHelp*> all_of(const CommandHelp& command) {
  std::vector<const CommandHelp*> all{&command};
  for (const CommandHelp& below : command.commands) {
    for (const CommandHelp* each : all_of(below)) all.push_back(each);
  }
  return all;
}

std::string last_word(const std::string& name) { return name.substr(name.rfind(' ') + 1); }

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size()) {
    text.replace(at, what.size(), by);
  }
  return text;
}

/// The name of a shell function: letters, digits and _.
std::string function_of(const std::string& command) {
  return fmt::format("_{}", replaced(page_name(command), "-", "_"));
}

/// The full names of all commands below the program, each in quotes.
std::vector<std::string> quoted_names(const CommandHelp& program, char quote) {
  std::vector<std::string> names;
  for (const CommandHelp* command : all_of(program)) {
    if (command != &program) names.push_back(quote + command->name + quote);
  }
  return names;
}

// ---- bash

/// A branch of the case over "COMMAND OPTION", for an option that takes a value.
std::string bash_value(const CommandHelp& command, const OptionHelp& option) {
  std::vector<std::string> patterns;
  for (const std::string& name : option.names) {
    patterns.push_back("\"" + command.name + " " + name + "\"");
  }
  std::string action = "return";
  switch (kind_of(option)) {
    case ValueKind::kChoice:
      action = fmt::format("words=\"{}\"", fmt::join(choices_of(option), " "));
      break;
    case ValueKind::kFile:
      action = "files=-f";
      break;
    case ValueKind::kFolder:
      action = "files=-d";
      break;
    case ValueKind::kNone:
    case ValueKind::kOther:
      break;
  }
  return fmt::format("    {}) {} ;;\n", fmt::join(patterns, " | "), action);
}

std::string bash_values(const CommandHelp& program) {
  std::string branches;
  for (const CommandHelp* command : all_of(program)) {
    for (const OptionHelp& option : command->options) {
      if (option.positional || kind_of(option) == ValueKind::kNone) continue;
      branches += bash_value(*command, option);
    }
  }
  return branches;
}

/// The branches of the case over commands: what may come next.
std::string bash_words(const CommandHelp& program) {
  std::string branches;
  for (const CommandHelp* command : all_of(program)) {
    std::vector<std::string> words;
    for (const CommandHelp& below : command->commands) words.push_back(last_word(below.name));
    for (const OptionHelp& option : command->options) {
      if (!option.positional) words.insert(words.end(), option.names.begin(), option.names.end());
    }
    branches += fmt::format("        \"{}\") words=\"{}\"{} ;;\n", command->name,
                            fmt::join(words, " "), has_positionals(*command) ? " files=-f" : "");
  }
  return branches;
}

// ---- zsh

/// Text inside the brackets of an _arguments specification, itself inside single quotes.
std::string zsh_text(const std::string& text) {
  std::string plain = replaced(first_line(text), "\\", "\\\\");
  for (const char* sign : {"[", "]", ":"}) plain = replaced(plain, sign, std::string("\\") + sign);
  return replaced(plain, "'", "'\\''");
}

std::string zsh_action(const OptionHelp& option) {
  switch (kind_of(option)) {
    case ValueKind::kChoice:
      return fmt::format(":value:({})", fmt::join(choices_of(option), " "));
    case ValueKind::kFile:
      return ":file:_files";
    case ValueKind::kFolder:
      return ":folder:_files -/";
    case ValueKind::kOther:
      return ":" + zsh_text(option.value) + ": ";
    case ValueKind::kNone:
      break;
  }
  return "";
}

std::string zsh_option(const OptionHelp& option) {
  const std::string end = fmt::format("[{}]{}'", zsh_text(option.description), zsh_action(option));
  const std::string star = option.repeated ? "*" : "";
  if (option.positional) return fmt::format("'{}:file:_files'", star);
  if (option.names.size() == 1) return "'" + star + option.names[0] + end;
  const std::string others =
      option.repeated ? star : fmt::format("({})", fmt::join(option.names, " "));
  return fmt::format("'{}'{{{}}}'{}", others, fmt::join(option.names, ","), end);
}

std::string zsh_function(const CommandHelp& command) {
  std::string text = function_of(command.name) + "() {\n";
  if (!command.commands.empty()) {
    text += "  (( CURRENT > 2 )) && case $words[2] in\n";
    for (const CommandHelp& below : command.commands) {
      text += fmt::format("    {}) shift words; (( CURRENT-- )); {}; return ;;\n",
                          last_word(below.name), function_of(below.name));
    }
    text += "  esac\n  local -a commands=(\n";
    for (const CommandHelp& below : command.commands) {
      text += fmt::format("    '{}:{}'\n", last_word(below.name),
                          replaced(first_line(below.summary), "'", "'\\''"));
    }
    text += "  )\n  (( CURRENT == 2 )) && _describe command commands\n";
  }
  text += "  _arguments -s";
  for (const OptionHelp& option : command.options) text += " \\\n    " + zsh_option(option);
  return text + "\n}\n\n";
}

// ---- fish

std::string fish_text(const std::string& text) {
  return fmt::format("'{}'", replaced(replaced(first_line(text), "\\", "\\\\"), "'", "\\'"));
}

std::string fish_option(const OptionHelp& option) {
  if (option.positional) return " -F";
  std::string line;
  for (const std::string& name : option.names) {
    line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  }
  switch (kind_of(option)) {
    case ValueKind::kChoice:
      line += fmt::format(" -x -a '{}'", fmt::join(choices_of(option), " "));
      break;
    case ValueKind::kFile:
      line += " -r -F";
      break;
    case ValueKind::kFolder:
      line += " -x -a '(__fish_complete_directories)'";
      break;
    case ValueKind::kOther:
      line += " -x";
      break;
    case ValueKind::kNone:
      break;
  }
  return line + " -d " + fish_text(option.description);
}

}  // namespace

std::string bash_completion(const CommandHelp& program) {
  const std::string function = function_of(program.name);
  std::string text = fmt::format("# bash completion of {}\n{}() {{\n", program.name, function);
  text += fmt::format(
      "  local current=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}}\n"
      "  local command={} word words= files=\n",
      program.name);
  if (!program.commands.empty()) {
    text += fmt::format(
        "  for word in \"${{COMP_WORDS[@]:1:COMP_CWORD-1}}\"; do\n"
        "    case \"$command $word\" in\n"
        "      {}) command+=\" $word\" ;;\n"
        "    esac\n"
        "  done\n",
        fmt::join(quoted_names(program, '"'), " | "));
  }
  text += "  COMPREPLY=()\n  case \"$command $before\" in\n" + bash_values(program) +
          "    *)\n      case \"$command\" in\n" + bash_words(program) + "      esac ;;\n  esac\n";
  text +=
      "  mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$current\"\n"
      "    [[ -z $files ]] || compgen \"$files\" -- \"$current\")\n"
      "  [[ -z $files ]] || compopt -o filenames 2>/dev/null\n"
      "}\n";
  return text + fmt::format("complete -F {} {}\n", function, program.name);
}

std::string zsh_completion(const CommandHelp& program) {
  std::string text =
      fmt::format("#compdef {}\n# zsh completion of {}\n\n", program.name, program.name);
  for (const CommandHelp* command : all_of(program)) text += zsh_function(*command);
  return text + function_of(program.name) + " \"$@\"\n";
}

std::string fish_completion(const CommandHelp& program) {
  const std::string is = fmt::format("_{}_is", function_of(program.name));
  std::string text = fmt::format(
      "# fish completion of {0}\n"
      "function {1}\n"
      "    set -l command {0}\n"
      "    set -l words (commandline -opc)\n"
      "    set -e words[1]\n"
      "    for word in $words\n"
      "        if contains -- \"$command $word\" {2}\n"
      "            set command \"$command $word\"\n"
      "        end\n"
      "    end\n"
      "    test \"$command\" = \"$argv[1]\"\n"
      "end\n"
      "complete -c {0} -f\n",
      program.name, is, fmt::join(quoted_names(program, '\''), " "));
  for (const CommandHelp* command : all_of(program)) {
    const std::string begin =
        fmt::format("complete -c {} -n '{} \"{}\"'", program.name, is, command->name);
    for (const CommandHelp& below : command->commands) {
      text +=
          fmt::format("{} -a {} -d {}\n", begin, last_word(below.name), fish_text(below.summary));
    }
    for (const OptionHelp& option : command->options) text += begin + fish_option(option) + "\n";
  }
  return text;
}

}  // namespace mvtp
