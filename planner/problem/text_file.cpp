#include "planner/problem/text_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

/// Owns a file descriptor.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }

  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] bool valid() const { return fd_ >= 0; }

  /// Closes now; false if the system reports late that writing failed (disk full, quota).
  bool close() {
    const int fd = fd_;
    fd_ = -1;
    return ::close(fd) == 0;
  }

 private:
  int fd_;
};

std::string reason(int error) { return std::strerror(error); }

/// The offset of the first byte that no text file holds, if there is one.
std::optional<std::size_t> find_control_byte(std::string_view text) {
  const auto is_control = [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 0x20 && c != '\n' && c != '\r' && c != '\t') || byte == 0x7f;
  };
  const auto found = std::find_if(text.begin(), text.end(), is_control);
  if (found == text.end()) return std::nullopt;
  return static_cast<std::size_t>(found - text.begin());
}

/// Length of the UTF-8 sequence that starts at `text[i]`, 0 if it is malformed (RFC 3629).
std::size_t utf8_length(std::string_view text, std::size_t i) {
  const auto byte = [&](std::size_t k) {
    return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u;
  };
  const auto continues = [&](std::size_t k) { return (byte(k) & 0xc0u) == 0x80u; };
  const unsigned first = byte(i);
  const unsigned second = byte(i + 1);
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first <= 0xdf && continues(i + 1)) return 2;
  const bool three = first >= 0xe0 && first <= 0xef && continues(i + 1) && continues(i + 2);
  if (three && !(first == 0xe0 && second < 0xa0) && !(first == 0xed && second >= 0xa0)) return 3;
  const bool four =
      first >= 0xf0 && first <= 0xf4 && continues(i + 1) && continues(i + 2) && continues(i + 3);
  if (four && !(first == 0xf0 && second < 0x90) && !(first == 0xf4 && second >= 0x90)) return 4;
  return 0;
}

std::optional<std::size_t> find_malformed_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8_length(text, i);
    if (length == 0) return i;
    i += length;
  }
  return std::nullopt;
}

[[noreturn]] void report_binary(const std::string& path, std::string_view text,
                                std::size_t offset) {
  throw InputError(path, fmt::format("is not a text file (byte 0x{:02x} at offset {}); give a YAML "
                                     "or JSON file in UTF-8",
                                     static_cast<unsigned char>(text[offset]), offset));
}

/// Devices, pipes and sockets cannot be replaced by a rename; they are written directly.
bool is_special(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  return fs::exists(status) && !fs::is_regular_file(status);
}

/// Where the bytes go in the end: the target of a link rather than the link, there or not.
fs::path final_target(const fs::path& path) {
  if (is_special(path)) return path;  // /dev/stdout may lead to a pipe, which has no name
  constexpr int kMostLinks = 40;      // as the kernel
  fs::path target = path;
  std::error_code error;
  for (int k = 0; k < kMostLinks && fs::is_symlink(target, error); ++k) {
    const fs::path next = fs::read_symlink(target, error);
    if (error) break;
    target = next.is_absolute() ? next : target.parent_path() / next;
  }
  return target;
}

[[noreturn]] void report_unwritable(const std::string& path, const std::string& why) {
  throw InputError(path, fmt::format("cannot be written: {}; choose another output file", why));
}

void reject_unwritable_target(const std::string& path, const fs::path& target) {
  if (path.empty()) throw InputError("output file", "has an empty name; give a path");
  std::error_code error;
  if (fs::is_symlink(target, error) && !is_special(target)) report_unwritable(path, reason(ELOOP));
  if (fs::is_directory(target, error)) report_unwritable(path, "it is a directory");
  if (fs::exists(target, error) && ::access(target.c_str(), W_OK) != 0) {
    report_unwritable(path, reason(errno));
  }
}

/// While it lives, this thread handles no signal that would end the program.
class SignalsHeldBack {
 public:
  SignalsHeldBack() {
    sigset_t set;
    sigemptyset(&set);
    for (const int signal : {SIGINT, SIGTERM}) sigaddset(&set, signal);
    ::pthread_sigmask(SIG_BLOCK, &set, &before_);
  }
  SignalsHeldBack(const SignalsHeldBack&) = delete;
  SignalsHeldBack& operator=(const SignalsHeldBack&) = delete;
  ~SignalsHeldBack() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

 private:
  sigset_t before_;
};

/// A new, empty file in the directory of `target`; removed again unless kept.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& path, const fs::path& target)
      : name_(new_name(target)), file_(::open(name_.c_str(), kNewFile, 0666)) {
    while (!file_.valid() && errno == EEXIST) {
      name_ = new_name(target);
      file_ = Descriptor(::open(name_.c_str(), kNewFile, 0666));
    }
    if (!file_.valid()) {
      name_.clear();
      report_unwritable(path, reason(errno));
    }
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (!name_.empty()) ::unlink(name_.c_str());
  }

  [[nodiscard]] Descriptor& file() { return file_; }

  /// Gives the file the name `target` and the rights of the file it replaces, or the usual ones.
  [[nodiscard]] bool rename_to(const fs::path& target) {
    struct stat old {};
    const bool is_new = ::stat(target.c_str(), &old) != 0;
    if (!is_new && ::chmod(name_.c_str(), old.st_mode & 07777u) != 0) return false;
    if (::rename(name_.c_str(), target.c_str()) != 0) return false;
    name_.clear();
    return true;
  }

 private:
  static constexpr int kNewFile = O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC;

  /// A name beside the target that is hardly taken.
  static std::string new_name(const fs::path& target) {
    static std::atomic<unsigned> count = 0;
    const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
    return fmt::format("{}.{:x}-{:x}-{:x}", target.string(), ::getpid(), now, count++);
  }

  SignalsHeldBack held_back_;  ///< until the file has its name or is removed
  std::string name_;
  Descriptor file_;
};

[[nodiscard]] bool write_all(int fd, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(fd, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

std::string read_text_file(const std::string& path, std::size_t max_bytes) {
  std::error_code error;
  if (fs::is_directory(path, error)) throw InputError(path, "is a directory; give a file");
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.valid()) {
    throw InputError(path, fmt::format("cannot be read: {}; check the path", reason(errno)));
  }

  std::string text;
  std::array<char, 1 << 16> block;
  while (true) {
    const ssize_t count = ::read(file.get(), block.data(), block.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw InputError(path, fmt::format("cannot be read: {}", reason(errno)));
    if (count == 0) break;
    const std::size_t begin = text.size();
    text.append(block.data(), static_cast<std::size_t>(count));
    if (const auto bad = find_control_byte(std::string_view(text).substr(begin))) {
      report_binary(path, text, begin + *bad);
    }
    if (text.size() > max_bytes) {
      throw InputError(
          path, fmt::format("is larger than {} MB; is it the right file?", max_bytes / 1'000'000));
    }
  }
  if (const auto bad = find_malformed_utf8(text)) report_binary(path, text, *bad);
  if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) {
    throw InputError(path, "is empty; give another file");
  }
  return text;
}

void check_writable(const std::string& path) {
  const fs::path target = final_target(path);
  reject_unwritable_target(path, target);
  if (!is_special(target)) TemporaryFile(path, target);
}

void write_text_file(const std::string& path, std::string_view content) {
  const fs::path target = final_target(path);
  reject_unwritable_target(path, target);
  if (is_special(target)) {
    Descriptor file(::open(target.c_str(), O_WRONLY | O_CLOEXEC));
    if (!file.valid() || !write_all(file.get(), content) || !file.close()) {
      report_unwritable(path, reason(errno));
    }
    return;
  }
  TemporaryFile beside(path, target);
  if (!write_all(beside.file().get(), content) || !beside.file().close() ||
      !beside.rename_to(target)) {
    report_unwritable(path, reason(errno));
  }
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace mvtp
