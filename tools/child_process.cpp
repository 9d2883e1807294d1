#include "tools/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <map>

#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

/// Looks after the children of run_jobs.
class JobRunner {
 public:
  JobRunner(std::span<const Job> jobs, int parallel,
            const std::function<bool(std::size_t, int)>& finished)
      : jobs_(jobs), parallel_(static_cast<std::size_t>(parallel)), finished_(finished) {}

  bool run() {
    while (true) {
      start_more();
      if (running_.empty()) return !interrupted_;
      const siginfo_t info = signals_.next();
      if (info.si_signo != SIGCHLD) interrupt(info);
      collect();
    }
  }

 private:
  void start_more() {
    while (!ending_ && next_ < jobs_.size() && running_.size() < parallel_) {
      const Job& job = jobs_[next_];
      running_[start_child(job.arguments.front(), job.arguments, signals_, job.messages)] = next_;
      ++next_;
    }
  }

  /// A signal to the whole process group arrives more than once within an instant: twice does no
  /// harm to the children, but it is no second wish to end.
  void interrupt(const siginfo_t& info) {
    constexpr auto kPatience = std::chrono::seconds(1);
    const auto now = std::chrono::steady_clock::now();
    if (!interrupted_) first_interrupt_ = now;
    send(now - first_interrupt_ > kPatience ? SIGKILL : info.si_signo);
    interrupted_ = ending_ = true;
  }

  void collect() {
    int status = 0;
    for (auto child = running_.begin(); child != running_.end();) {
      if (waitpid(child->first, &status, WNOHANG) == 0) {
        ++child;
        continue;
      }
      const std::size_t job = child->second;
      child = running_.erase(child);
      if (!finished_(job, status) && !ending_) {
        send(SIGTERM);
        ending_ = true;
      }
    }
  }

  void send(int signal) const {
    for (const auto& [child, job] : running_) kill(child, signal);
  }

  std::span<const Job> jobs_;
  std::size_t parallel_;
  const std::function<bool(std::size_t, int)>& finished_;
  AwaitedSignals signals_;
  std::map<pid_t, std::size_t> running_;
  std::size_t next_ = 0;
  bool ending_ = false;
  bool interrupted_ = false;
  std::chrono::steady_clock::time_point first_interrupt_{};
};

}  // namespace

AwaitedSignals::AwaitedSignals() {
  sigemptyset(&set_);
  for (const int signal : {SIGINT, SIGTERM, SIGCHLD}) sigaddset(&set_, signal);
  sigprocmask(SIG_BLOCK, &set_, &before_);
}

AwaitedSignals::~AwaitedSignals() { sigprocmask(SIG_SETMASK, &before_, nullptr); }

siginfo_t AwaitedSignals::next() const {
  siginfo_t info{};
  while (sigwaitinfo(&set_, &info) < 0) {  // EINTR: a stop and a continue
  }
  return info;
}

pid_t start_child(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                  const AwaitedSignals& signals, const std::filesystem::path& messages) {
  std::vector<std::string> words = arguments;
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (!messages.empty()) {
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, messages.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0666);
    posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
  }
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setsigmask(&attributes, &signals.before());
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  pid_t child = 0;
  const int error =
      posix_spawn(&child, program.c_str(), &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw InputError(program.string(),
                     fmt::format("cannot be run: {}; install mvtp again", std::strerror(error)));
  }
  return child;
}

bool run_jobs(std::span<const Job> jobs, int parallel,
              const std::function<bool(std::size_t, int)>& finished) {
  return JobRunner(jobs, parallel, finished).run();
}

}  // namespace mvtp
