#include "tools/runs/row_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <exception>
#include <filesystem>
#include <utility>

#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "tools/runs/same_options.hpp"

namespace mvtp {
namespace {

[[noreturn]] void report_unwritable(const std::string& path) {
  throw InputError(
      path, fmt::format("cannot be written: {}; choose another --output", std::strerror(errno)));
}

}  // namespace

RowFile::RowFile(std::string path, Mode mode, const Format& format,
                 const std::function<std::size_t(std::string_view)>& read)
    : path_(std::move(path)),
      file_(::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666)) {
  if (file_ < 0) report_unwritable(path_);
  try {
    begin(mode, format, read);
  } catch (...) {
    if (is_without_rows_) discard();
    ::close(file_);
    throw;
  }
}

void RowFile::begin(Mode mode, const Format& format,
                    const std::function<std::size_t(std::string_view)>& read) {
  if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
    throw InputError(
        path_, fmt::format("is written by another {}; choose another --output", format.command));
  }
  const off_t size = ::lseek(file_, 0, SEEK_END);
  if (size < 0) throw InputError(path_, "is no regular file; choose another --output");
  if (size > 0 && mode == Mode::kCreate) {
    throw InputError(path_, "exists; continue it with --resume, or choose another --output");
  }
  if (size > 0) {
    const std::string content = read_text_file(path_, kMostRowBytes);
    // Only its end may be missing: what stands there must begin like one of mvtp's.
    if (!format.header.starts_with(content.substr(0, format.header.size()))) {
      throw InputError(path_, "is no results.csv; choose another --output");
    }
    size_ = read(content);
  }
  if (::ftruncate(file_, off_t(size_)) != 0) report_unwritable(path_);
  is_without_rows_ = size_ == 0;
  if (is_without_rows_) write(format.header);
}

RowFile::~RowFile() {
  if (is_without_rows_ && std::uncaught_exceptions() > 0) discard();
  ::close(file_);
}

void RowFile::append(std::string_view line) {
  write(line);
  is_without_rows_ = false;
}

void RowFile::write(std::string_view line) {
  ssize_t written = -1;
  while ((written = ::write(file_, line.data(), line.size())) < 0 && errno == EINTR) {
  }
  if (written != ssize_t(line.size())) {
    if (::ftruncate(file_, off_t(size_)) != 0) report_unwritable(path_);  // half a line
    throw InputError(path_, "cannot be written: is the disk full? Make room and use --resume");
  }
  size_ += line.size();
}

void RowFile::discard() const {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (::ftruncate(file_, 0) != 0) return;
  if (fs::is_regular_file(fs::symlink_status(path_, ignored))) fs::remove(path_, ignored);
  fs::remove(options_note(path_), ignored);
}

}  // namespace mvtp
