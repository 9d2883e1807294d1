#pragma once

#include <sys/types.h>

#include <csignal>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "planner/problem/deadline.hpp"

namespace mvtp {

/// While it lives, SIGINT, SIGTERM and SIGCHLD are waited for instead of handled: what a process
/// needs that does nothing but look after children. There must not be two.
class AwaitedSignals {
 public:
  AwaitedSignals();
  AwaitedSignals(const AwaitedSignals&) = delete;
  AwaitedSignals& operator=(const AwaitedSignals&) = delete;
  ~AwaitedSignals();

  /// Waits for the next one; nullopt if none came until `latest`.
  [[nodiscard]] std::optional<siginfo_t> next(Deadline latest = Deadline::never()) const;
  /// The signals that were blocked before, as a child needs them.
  [[nodiscard]] const sigset_t& before() const { return before_; }

 private:
  sigset_t set_;
  sigset_t before_;
};

/// Where an executable of this name is on the PATH.
[[nodiscard]] std::optional<std::filesystem::path> find_program(const std::string& name);

/// Ends this process by SIGTERM once the one that started it by start_child() has died, however.
void end_with_parent();

/// Starts a program with the signals as they were before `signals`, but that it hears SIGINT and
/// SIGTERM even where this process ignored them.
/// @param arguments  argv, the program's name first.
/// @param messages   file that takes the child's stdout and stderr; empty: those of this process.
/// @throws InputError if the program cannot be run.
[[nodiscard]] pid_t start_child(const std::filesystem::path& program,
                                const std::vector<std::string>& arguments,
                                const AwaitedSignals& signals,
                                const std::filesystem::path& messages = {});

/// One program to run.
struct Job {
  std::vector<std::string> arguments;  ///< argv; the first is the program's path
  std::filesystem::path messages;      ///< file for what it prints
  double time_limit = 1e9;             ///< killed after so long [s]
  std::size_t tag = 0;                 ///< for whoever made the job
};

/// How a job ended.
struct JobEnd {
  int status = 0;            ///< of waitpid()
  double seconds = 0.0;      ///< wall clock
  double peak_rss = 0.0;     ///< most memory it had at once [MiB]
  bool out_of_time = false;  ///< killed for its time limit
  bool interrupted = false;  ///< a signal to this process ended it, or another job's end did
};

/// Where the jobs come from, one after the other; an end may lead to further jobs.
class JobSource {
 public:
  JobSource() = default;
  JobSource(const JobSource&) = delete;
  JobSource& operator=(const JobSource&) = delete;
  virtual ~JobSource() = default;

  /// The job to start next, asked for when there is room for one; nullopt: none for now.
  [[nodiscard]] virtual std::optional<Job> next() = 0;
  /// Called as each job ends. @return false to end everything: no more jobs are started, and those
  /// that run get SIGTERM.
  [[nodiscard]] virtual bool finished(const Job& job, const JobEnd& end) = 0;
};

/// Runs jobs as child processes, at most `parallel` at once, until none runs and none is left.
///
/// SIGINT and SIGTERM are passed on to the children, and nothing more is started; one that comes a
/// second later kills them.
/// @return true unless a signal ended it early.
[[nodiscard]] bool run_jobs(JobSource& source, int parallel);

/// The same for a fixed list of jobs, in this order; `finished(i, status)` is called with the
/// status of waitpid() and may return false to end everything.
[[nodiscard]] bool run_jobs(std::span<const Job> jobs, int parallel,
                            const std::function<bool(std::size_t, int)>& finished);

}  // namespace mvtp
