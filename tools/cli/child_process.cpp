#include "tools/cli/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <map>
#include <utility>

#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

/// The environment variable by which a child knows who started it.
constexpr const char* kParent = "MVTP_PARENT";

/// Looks after the children of run_jobs.
class JobRunner {
 public:
  JobRunner(JobSource& source, int parallel)
      : source_(source), parallel_(static_cast<std::size_t>(parallel)) {}
  JobRunner(const JobRunner&) = delete;
  JobRunner& operator=(const JobRunner&) = delete;
  /// Nobody is left behind, should something have been thrown.
  ~JobRunner() {
    send(SIGKILL);
    for (const auto& [id, child] : running_) waitpid(id, nullptr, 0);
  }

  bool run() {
    while (true) {
      start_more();
      if (running_.empty()) return !interrupted_;
      const std::optional<siginfo_t> info = signals_.next(first_deadline());
      if (info && info->si_signo != SIGCHLD) interrupt(*info);
      kill_overdue();
      collect();
    }
  }

 private:
  struct Child {
    Job job;
    Deadline::Clock::time_point started;
    Deadline latest;
    bool out_of_time = false;
  };

  void start_more() {
    while (!ending_ && running_.size() < parallel_) {
      std::optional<Job> job = source_.next();
      if (!job) return;
      const pid_t child =
          start_child(job->arguments.front(), job->arguments, signals_, job->messages);
      const Deadline latest = Deadline::in(job->time_limit);
      running_.emplace(child, Child{std::move(*job), Deadline::Clock::now(), latest});
    }
  }

  [[nodiscard]] Deadline first_deadline() const {
    Deadline first = Deadline::never();
    for (const auto& [id, child] : running_) {
      if (!child.out_of_time) first = first.within(child.latest.remaining());
    }
    return first;
  }

  void kill_overdue() {
    for (auto& [id, child] : running_) {
      if (child.out_of_time || !child.latest.expired()) continue;
      child.out_of_time = true;
      kill(id, SIGKILL);
    }
  }

  /// A signal to the whole process group arrives more than once at nearly the same time: twice does
  /// no harm to the children, but it is no second wish to end.
  void interrupt(const siginfo_t& info) {
    constexpr auto kGracePeriod = std::chrono::seconds(1);
    const auto now = std::chrono::steady_clock::now();
    if (!interrupted_) first_interrupt_ = now;
    send(now - first_interrupt_ > kGracePeriod ? SIGKILL : info.si_signo);
    interrupted_ = ending_ = true;
  }

  void collect() {
    int status = 0;
    rusage usage{};
    for (auto entry = running_.begin(); entry != running_.end();) {
      if (wait4(entry->first, &status, WNOHANG, &usage) == 0) {
        ++entry;
        continue;
      }
      const Child child = std::move(entry->second);
      entry = running_.erase(entry);
      const std::chrono::duration<double> time = Deadline::Clock::now() - child.started;
      const JobEnd end{status, time.count(), double(usage.ru_maxrss) / 1024.0, child.out_of_time,
                       ending_};
      if (!source_.finished(child.job, end) && !ending_) {
        send(SIGTERM);
        ending_ = true;
      }
    }
  }

  void send(int signal) const {
    for (const auto& [id, child] : running_) kill(id, signal);
  }

  JobSource& source_;
  std::size_t parallel_;
  AwaitedSignals signals_;
  std::map<pid_t, Child> running_;
  bool ending_ = false;
  bool interrupted_ = false;
  std::chrono::steady_clock::time_point first_interrupt_{};
};

/// A fixed list of jobs.
class JobList : public JobSource {
 public:
  JobList(std::span<const Job> jobs, const std::function<bool(std::size_t, int)>& finished)
      : jobs_(jobs), finished_(finished) {}

  [[nodiscard]] std::optional<Job> next() override {
    if (next_ == jobs_.size()) return std::nullopt;
    Job job = jobs_[next_];
    job.tag = next_++;
    return job;
  }
  [[nodiscard]] bool finished(const Job& job, const JobEnd& end) override {
    return finished_(job.tag, end.status);
  }

 private:
  std::span<const Job> jobs_;
  const std::function<bool(std::size_t, int)>& finished_;
  std::size_t next_ = 0;
};

}  // namespace

AwaitedSignals::AwaitedSignals() {
  sigemptyset(&set_);
  for (const int signal : {SIGINT, SIGTERM, SIGCHLD}) sigaddset(&set_, signal);
  sigprocmask(SIG_BLOCK, &set_, &before_);
}

AwaitedSignals::~AwaitedSignals() { sigprocmask(SIG_SETMASK, &before_, nullptr); }

std::optional<siginfo_t> AwaitedSignals::next(Deadline latest) const {
  siginfo_t info{};
  while (true) {
    const double seconds = std::max(latest.remaining(), 0.0);
    const timespec timeout{std::time_t(seconds), long(1e9 * (seconds - std::floor(seconds)))};
    if (sigtimedwait(&set_, &info, &timeout) >= 0) return info;
    if (errno == EAGAIN) return std::nullopt;  // else EINTR: a stop and a continue
  }
}

std::optional<std::filesystem::path> find_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::string rest = path == nullptr ? "" : path;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    std::filesystem::path file = std::filesystem::path(rest.substr(0, end)) / name;
    if (::access(file.c_str(), X_OK) == 0) return file;
    rest.erase(0, std::min(end + 1, rest.size()));
  }
  return std::nullopt;
}

void end_with_parent() {
  const char* const parent = std::getenv(kParent);
  if (parent == nullptr || parent != std::to_string(::getppid())) return;
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (parent != std::to_string(::getppid())) std::raise(SIGTERM);  // it died just before
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
  // A shell that starts this process in the background has it ignore SIGINT. It awaits the signals
  // all the same and passes them on, so its child has to hear them.
  sigset_t heard;
  sigemptyset(&heard);
  for (const int signal : {SIGINT, SIGTERM}) sigaddset(&heard, signal);
  posix_spawnattr_setsigdefault(&attributes, &heard);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  pid_t child = 0;
  ::setenv(kParent, std::to_string(::getpid()).c_str(), 1);
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

bool run_jobs(JobSource& source, int parallel) { return JobRunner(source, parallel).run(); }

bool run_jobs(std::span<const Job> jobs, int parallel,
              const std::function<bool(std::size_t, int)>& finished) {
  JobList list(jobs, finished);
  return run_jobs(list, parallel);
}

}  // namespace mvtp
