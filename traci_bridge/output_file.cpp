#include "traci_bridge/output_file.hpp"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "planner/problem/input_error.hpp"

namespace mvtp {

OutputFile::OutputFile(std::string path) : path_(std::move(path)) {
  if (path_.find(':') != std::string::npos) {
    throw InputError(path_, "SUMO takes a path with a colon for host:port; choose another");
  }
  if (std::filesystem::is_directory(path_)) {
    throw InputError(path_, "is a directory; give the path of a file to write");
  }
  if (!std::ofstream(part())) {
    throw InputError(path_, "cannot be written (" + std::generic_category().message(errno) +
                                "); choose another directory");
  }
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)), pending_(std::exchange(other.pending_, false)) {}

OutputFile::~OutputFile() {
  std::error_code ignored;
  if (pending_) std::filesystem::remove(part(), ignored);
}

void OutputFile::commit() {
  std::error_code error;
  std::filesystem::rename(part(), path_, error);
  if (error) throw InputError(path_, "cannot be written (" + error.message() + ")");
  pending_ = false;
}

}  // namespace mvtp
