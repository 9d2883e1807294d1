#pragma once

#include <filesystem>
#include <string>

namespace mvtp {

/// Makes the folder and those above it, unless it is there.
/// @param option  the option that names it, for the message.
/// @throws InputError if that is impossible.
void make_output_folder(const std::string& folder, const std::string& option);

/// Is there hardly any room in the folder?
[[nodiscard]] bool is_full(const std::filesystem::path& folder);

/// Runs that fill the disk lose more than those that never begin.
/// @throws InputError if the folder is full.
void require_room(const std::string& folder, const std::string& option);

}  // namespace mvtp
