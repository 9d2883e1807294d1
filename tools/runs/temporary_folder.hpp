#pragma once

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>

#include "planner/problem/input_error.hpp"
#include "tools/cli/output_folder.hpp"

namespace mvtp {

/// A folder for what only this process needs, removed with all that is in it.
class TemporaryFolder {
 public:
  /// @throws InputError if it cannot be made, or there is no room in it.
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
    if (is_full(path_)) {
      std::filesystem::remove(path_, error);
      throw InputError(name, "the disk is full; make room or set TMPDIR to another folder");
    }
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// A job that failed for want of room tells nothing of what it was to measure.
  /// @param said  its last words.
  /// @throws InputError if it was that.
  void rule_out_full_disk(const std::string& said) const {
    bool full = is_full(path_) || said.find("disk full") != std::string::npos;
    for (const int error : {ENOSPC, EDQUOT, EFBIG}) {
      full = full || said.find(std::strerror(error)) != std::string::npos;
    }
    if (!full) return;
    throw InputError(said.empty() ? path_.string() : said.substr(0, said.find(": ")),
                     "the disk is full; make room or set TMPDIR to another folder, and use "
                     "--resume");
  }

 private:
  std::filesystem::path path_;
};

}  // namespace mvtp
