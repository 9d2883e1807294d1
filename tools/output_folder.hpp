#pragma once

#include <string>

namespace mvtp {

/// Makes the folder and those above it, unless it is there.
/// @param option  the option that names it, for the message.
/// @throws InputError if that is impossible.
void make_output_folder(const std::string& folder, const std::string& option);

}  // namespace mvtp
