#pragma once

#include "tools/compare/options.hpp"

namespace mvtp {

/// Runs one demand under every control that there is, as `mvtp compare` does, writes the files and
/// prints the table. Returns the exit code.
/// @throws InputError
int run_compare(const CompareOptions& options);

}  // namespace mvtp
