#include "tools/output_folder.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "planner/problem/input_error.hpp"

namespace mvtp {

void make_output_folder(const std::string& folder, const std::string& option) {
  if (folder.empty()) throw InputError(option, "is empty; give a folder");
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error && std::filesystem::is_directory(folder)) return;
  throw InputError(folder, fmt::format("cannot make this folder ({}); choose another {}",
                                       error ? error.message() : "a file has this name", option));
}

}  // namespace mvtp
