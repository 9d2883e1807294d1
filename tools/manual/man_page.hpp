#pragma once

#include <string>

#include "tools/manual/command_help.hpp"

namespace mvtp {

/// "mvtp-toio-fit" for the command "mvtp toio fit".
[[nodiscard]] std::string page_name(const std::string& command);

/// The page of section 1 of one command, in man(7). It names the pages of the commands below it.
/// @param above  the command that it belongs to; nullptr: it is a program
[[nodiscard]] std::string man_page(const CommandHelp& command, const CommandHelp* above,
                                   const std::string& version);

}  // namespace mvtp
