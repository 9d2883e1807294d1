#include "traci_bridge/output_file.hpp"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

/// Is the last line the end of the root element? SUMO says nothing when it cannot write.
bool is_whole(const std::string& path) {
  constexpr std::streamoff kLongest = 1000;  // of such a line: an empty root has attributes
  std::ifstream file(path, std::ios::ate);
  file.seekg(std::max(std::streamoff(file.tellg()) - kLongest, std::streamoff(0)));
  std::string last;
  for (std::string line; std::getline(file, line);) last = std::move(line);
  return (last.starts_with("</") && last.ends_with(">")) ||
         (last.starts_with("<") && last.ends_with("/>"));
}

}  // namespace

OutputFile::OutputFile(std::string path, const std::string& prefix) : path_(std::move(path)) {
  const std::filesystem::path plain(part());
  written_ = (plain.parent_path() / (prefix + plain.filename().string())).string();
  if (path_.find(':') != std::string::npos) {
    throw InputError(path_, "SUMO takes a path with a colon for host:port; choose another");
  }
  if (std::filesystem::is_directory(path_)) {
    throw InputError(path_, "is a directory; give the path of a file to write");
  }
  std::error_code ignored;
  if (prefix.find('/') != std::string::npos) {
    std::filesystem::create_directories(std::filesystem::path(written_).parent_path(), ignored);
  }
  if (!std::ofstream(written_)) {
    throw InputError(path_, "cannot be written (" + std::generic_category().message(errno) +
                                "); choose another directory");
  }
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)),
      written_(std::move(other.written_)),
      pending_(std::exchange(other.pending_, false)) {}

OutputFile::~OutputFile() {
  std::error_code ignored;
  if (pending_) std::filesystem::remove(written_, ignored);
}

void OutputFile::commit() {
  if (!is_whole(written_)) {
    std::error_code ignored;
    std::filesystem::remove(written_, ignored);  // makes room for the rest
    throw InputError(path_, "is cut off: is the disk full? Make room, or choose another directory");
  }
  std::error_code error;
  std::filesystem::rename(written_, path_, error);
  if (error) throw InputError(path_, "cannot be written (" + error.message() + ")");
  pending_ = false;
}

}  // namespace mvtp
