#pragma once

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "coordinator/traffic.hpp"
#include "planner/problem/input_error.hpp"

namespace mvtp {

/// A directory of its own for each test process, removed at its end.
class TemporaryDirectory {
 public:
  TemporaryDirectory()
      : path_(std::filesystem::temp_directory_path() / ("mvtp-test-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_);
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  ~TemporaryDirectory() { std::filesystem::remove_all(path_); }

  [[nodiscard]] std::string operator/(const std::string& name) const { return path_ / name; }

  /// Writes a file and returns its path.
  std::string write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

/// The message of the InputError that the call throws; "" if it throws none.
template <class Call>
std::string message_of(const Call& call) {
  try {
    static_cast<void>(call());
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// The path of a file of the project.
inline std::string project_file(const std::string& name) {
  return std::string(MVTP_SOURCE_DIR) + '/' + name;
}

/// The vehicle of that name, or nullptr.
inline const VehicleState* find(const Traffic& traffic, const std::string& id) {
  const auto found = std::ranges::find(traffic.vehicles(), id, &VehicleState::id);
  return found == traffic.vehicles().end() ? nullptr : &*found;
}

}  // namespace mvtp
