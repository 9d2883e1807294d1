#pragma once

#include <sys/types.h>

#include <csignal>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace mvtp {

/// While it lives, SIGINT, SIGTERM and SIGCHLD are waited for instead of handled: what a process
/// needs that does nothing but look after children. One at a time.
class AwaitedSignals {
 public:
  AwaitedSignals();
  AwaitedSignals(const AwaitedSignals&) = delete;
  AwaitedSignals& operator=(const AwaitedSignals&) = delete;
  ~AwaitedSignals();

  /// Waits for the next one.
  [[nodiscard]] siginfo_t next() const;
  /// The signals that were blocked before, as a child needs them.
  [[nodiscard]] const sigset_t& before() const { return before_; }

 private:
  sigset_t set_;
  sigset_t before_;
};

/// Starts a program with the signals as they were before `signals`.
/// @param arguments  argv, the program's name first.
/// @param messages   file that takes the child's stdout and stderr; empty: those of this process.
/// @throws InputError if the program cannot be run.
[[nodiscard]] pid_t start_child(const std::filesystem::path& program,
                                const std::vector<std::string>& arguments,
                                const AwaitedSignals& signals,
                                const std::filesystem::path& messages = {});

/// One program to run, and how it ended.
struct Job {
  std::vector<std::string> arguments;  ///< argv; the first is the program's path
  std::filesystem::path messages;      ///< file for what it prints
};

/// Runs the jobs as child processes, at most `parallel` at once, in this order.
///
/// `finished(i, status)` is called with the status of waitpid() as each one ends; if it returns
/// false no more are started and those that run get SIGTERM. SIGINT and SIGTERM are passed on to
/// the children, and nothing more is started; one that comes a second later kills them.
/// @return true unless a signal ended it early.
[[nodiscard]] bool run_jobs(std::span<const Job> jobs, int parallel,
                            const std::function<bool(std::size_t, int)>& finished);

}  // namespace mvtp
