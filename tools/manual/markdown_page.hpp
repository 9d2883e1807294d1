#pragma once

#include <string>

#include "tools/manual/command_help.hpp"

namespace mvtp {

/// The reference of one program for the site of the docs, in Markdown: a section per command with
/// its options, in the groups of its help.
[[nodiscard]] std::string markdown_reference(const CommandHelp& program);

}  // namespace mvtp
