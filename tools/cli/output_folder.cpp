#include "tools/cli/output_folder.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>

#include "planner/problem/input_error.hpp"

namespace mvtp {

namespace fs = std::filesystem;

bool is_full(const fs::path& folder) {
  constexpr std::uintmax_t kLeastSpace = 1'000'000;  // [bytes]
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  return !error && space.available < kLeastSpace;
}

void require_room(const std::string& folder, const std::string& option) {
  if (!is_full(folder)) return;
  throw InputError(folder, fmt::format("the disk is full; make room or choose another {}", option));
}

void make_output_folder(const std::string& folder, const std::string& option) {
  if (folder.empty()) throw InputError(option, "is empty; give a folder");
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error && fs::is_directory(folder)) return;
  throw InputError(folder, fmt::format("cannot make this folder ({}); choose another {}",
                                       error ? error.message() : "a file has this name", option));
}

}  // namespace mvtp
