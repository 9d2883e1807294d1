#pragma once

#include <string>

namespace mvtp {

/// This process's command line as it was typed, for the record; it begins with "mvtp".
[[nodiscard]] std::string command_line();

}  // namespace mvtp
