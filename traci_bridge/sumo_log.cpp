#include "traci_bridge/sumo_log.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <iostream>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

constexpr std::string_view kError = "Error: ";
constexpr std::string_view kWarning = "Warning: ";
/// What the audit tells already, and more exactly.
constexpr std::array<std::string_view, 4> kTold = {"emergency braking", "emergency stop",
                                                   "collision with", "moved by TraCI"};
constexpr std::size_t kShown = 3;
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
  if (errors.size() > kLongestMessage) {
    errors.resize(kLongestMessage);
    errors += "...";
  }
  return errors;
}

}  // namespace

SumoLog::SumoLog(const std::string& path)
    : file_(path.empty() ? std::tmpfile() : std::fopen(path.c_str(), "w+")) {
  if (!file_) {
    const std::string where = path.empty() ? "temporary file" : path;
    throw InputError(where, "cannot be written (" + std::generic_category().message(errno) + ")");
  }
  fcntl(descriptor(), F_SETFD, FD_CLOEXEC);
  fcntl(descriptor(), F_SETFL, O_APPEND);
}

int SumoLog::descriptor() const { return fileno(file_.get()); }

std::string SumoLog::text_from(off_t begin) const {
  std::string log;
  std::array<char, 4096> block{};
  for (off_t at = begin;;) {
    const ssize_t count = pread(descriptor(), block.data(), block.size(), at);
    if (count <= 0) break;
    log.append(block.data(), static_cast<std::size_t>(count));
    at += count;
  }
  return log;
}

std::string SumoLog::take_errors() {
  const std::string log = text_from(taken_);
  taken_ += static_cast<off_t>(log.size());
  return errors_in(log);
}

SumoWarnings SumoLog::warnings() const {
  SumoWarnings warnings;
  std::istringstream lines(text_from(0));
  std::string line;
  while (std::getline(lines, line)) {
    if (!line.starts_with(kWarning)) continue;
    ++warnings.count;
    const bool told = std::ranges::any_of(
        kTold, [&](std::string_view word) { return line.find(word) != std::string::npos; });
    if (told) continue;
    ++warnings.untold;
    if (warnings.first.size() < kShown) warnings.first.push_back(line.substr(kWarning.size()));
  }
  return warnings;
}

SumoLog::Redirection::Redirection(const SumoLog& log)
    : stdout_(fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0)),
      stderr_(fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 0)) {
  std::fflush(stdout);
  dup2(log.descriptor(), STDOUT_FILENO);
  dup2(log.descriptor(), STDERR_FILENO);
}

SumoLog::Redirection::~Redirection() {
  std::cout.flush();
  std::fflush(stdout);
  for (const auto& [kept, stream] : {std::pair{stdout_, STDOUT_FILENO}, {stderr_, STDERR_FILENO}}) {
    dup2(kept, stream);
    close(kept);
  }
}

}  // namespace mvtp
