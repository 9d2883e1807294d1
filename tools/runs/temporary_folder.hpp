#pragma once

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>

#include "planner/problem/input_error.hpp"

namespace mvtp {

/// A folder for what only this process needs, removed with all that is in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code error;
    const std::filesystem::path parent = std::filesystem::temp_directory_path(error);
    if (error) {
      throw InputError("TMPDIR", "names no folder (" + error.message() + "); set it to another");
    }
    std::string name = (parent / "mvtp-runs-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw InputError(name, std::string("cannot make this folder (") + std::strerror(errno) +
                                 "); set TMPDIR to another");
    }
    path_ = name;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace mvtp
