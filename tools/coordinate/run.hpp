#pragma once

#include <string>

#include "tools/coordinate/options.hpp"

namespace mvtp {

/// Runs a scenario as `mvtp coordinate` does and writes its files. Returns the exit code.
/// @param command  the command line, for the record.
/// @throws InputError
int run_coordinate(const CoordinateOptions& options, const std::string& command);

}  // namespace mvtp
