#pragma once

#include <string>
#include <vector>

namespace mvtp {

/// Finds out before any long work whether the output files can be written, and whether one of them
/// is an input, or named twice: also through a link. Empty names are left out.
/// @throws InputError
void check_output_files(const std::vector<std::string>& outputs,
                        const std::vector<std::string>& inputs);

}  // namespace mvtp
