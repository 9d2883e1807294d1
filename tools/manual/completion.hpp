#pragma once

#include <string>

#include "tools/manual/command_help.hpp"

namespace mvtp {

// Scripts that complete a program's commands, options, choices and files.
[[nodiscard]] std::string bash_completion(const CommandHelp& program);
[[nodiscard]] std::string zsh_completion(const CommandHelp& program);
[[nodiscard]] std::string fish_completion(const CommandHelp& program);

}  // namespace mvtp
