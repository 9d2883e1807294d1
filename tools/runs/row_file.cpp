#include "tools/runs/row_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"

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
  if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
    throw InputError(
        path_, fmt::format("is written by another {}; choose another --output", format.command));
  }
  const off_t size = ::lseek(file_, 0, SEEK_END);
  if (size < 0) throw InputError(path_, "is no regular file; choose another --output");
  if (size > 0 && mode == Mode::kCreate) {
    throw InputError(path_, "exists; continue it with --resume, or choose another --output");
  }
  std::size_t kept = 0;
  if (size > 0) {
    const std::string content = read_text_file(path_, kMostRowBytes);
    // Only its end may be missing: what stands there must begin like one of mvtp's.
    if (!format.header.starts_with(content.substr(0, format.header.size()))) {
      throw InputError(path_, "is no results.csv; choose another --output");
    }
    kept = read(content);
  }
  if (::ftruncate(file_, off_t(kept)) != 0) report_unwritable(path_);
  if (kept == 0) append(format.header);
}

RowFile::~RowFile() { ::close(file_); }

void RowFile::append(std::string_view line) {
  ssize_t written = -1;
  while ((written = ::write(file_, line.data(), line.size())) < 0 && errno == EINTR) {
  }
  if (written != ssize_t(line.size())) {
    throw InputError(path_, "cannot be written: is the disk full? Make room and use --resume");
  }
}

}  // namespace mvtp
