#pragma once

#include <filesystem>
#include <string>

namespace mvtp {

/// Where the executable `name` lies that belongs to the running one: ../libexec/mvtp/NAME from its
/// directory, in the build tree as where it is installed.
[[nodiscard]] std::filesystem::path sibling_path(const std::string& name);

/// Where a data file of the program lies: ../share/mvtp/NAME from its directory.
[[nodiscard]] std::filesystem::path shared_file(const std::string& name);

/// Runs the sibling with the same arguments, as a child process, and returns its exit code.
///
/// SUMO's libraries are loaded only there: no other command pays for them, and a crash inside them
/// ends as one line here (kNotAchieved). SIGINT and SIGTERM reach the child once, however sent.
/// @throws InputError if there is no such executable, as in a build without SUMO.
[[nodiscard]] int run_sibling(const std::string& name, int argc, char** argv);

}  // namespace mvtp
