#pragma once

#include <string>
#include <vector>

namespace mvtp {

/// FILE.options.
[[nodiscard]] std::string options_note(const std::string& file);

/// Runs with different options never stand in one table: the options of the runs in FILE are kept
/// in FILE.options, one per line.
/// @param resume  FILE is gone on with, so they must be the same; else they are written.
/// @throws InputError if they differ.
void require_same_options(const std::string& file, const std::vector<std::string>& options,
                          bool resume);

}  // namespace mvtp
