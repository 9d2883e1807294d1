#include "traci_bridge/sumo_log.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <sstream>
#include <string_view>
#include <system_error>

namespace mvtp {
namespace {

constexpr std::string_view kError = "Error: ";
constexpr std::size_t kLongestMessage = 600;

/// The error messages of a log: lines that begin with "Error: ", and the indented ones after them.
std::string errors_in(const std::string& log) {
  std::istringstream lines(log);
  std::string line;
  std::string errors;
  bool in_error = false;
  while (std::getline(lines, line)) {
    const bool begins = line.starts_with(kError);
    in_error = begins || (in_error && line.starts_with(' '));
    if (!in_error) continue;
    const std::size_t text = begins ? kError.size() : line.find_first_not_of(' ');
    if (text >= line.size()) continue;
    if (!errors.empty() && !errors.ends_with(' ')) errors += ' ';
    errors += line.substr(text);
  }
  if (errors.size() > kLongestMessage) errors = errors.substr(0, kLongestMessage) + "...";
  return errors;
}

}  // namespace

SumoLog::SumoLog() : file_(std::tmpfile()) {
  if (!file_) throw std::system_error(errno, std::generic_category(), "temporary file");
  fcntl(descriptor(), F_SETFD, FD_CLOEXEC);
  fcntl(descriptor(), F_SETFL, O_APPEND);
}

int SumoLog::descriptor() const { return fileno(file_.get()); }

std::string SumoLog::take_errors() {
  std::string log;
  std::array<char, 4096> block{};
  for (off_t at = 0;;) {
    const ssize_t count = pread(descriptor(), block.data(), block.size(), at);
    if (count <= 0) break;
    log.append(block.data(), static_cast<std::size_t>(count));
    at += count;
  }
  if (ftruncate(descriptor(), 0) != 0) log.clear();
  return errors_in(log);
}

SumoLog::Redirection::Redirection(const SumoLog& log)
    : stderr_(fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 0)) {
  dup2(log.descriptor(), STDERR_FILENO);
}

SumoLog::Redirection::~Redirection() {
  dup2(stderr_, STDERR_FILENO);
  close(stderr_);
}

}  // namespace mvtp
