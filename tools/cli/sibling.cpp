#include "tools/cli/sibling.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <climits>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "planner/problem/input_error.hpp"
#include "tools/cli/child_process.hpp"
#include "tools/cli/program.hpp"
#include "tools/cli/run_folder.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

/// The directory above that of this program.
fs::path prefix() { return fs::read_symlink("/proc/self/exe").parent_path().parent_path(); }

/// Waits for the child's end. A signal from a terminal reaches the whole process group and so the
/// child itself; one that somebody sent to this process alone is passed on.
int wait_for(pid_t child, const AwaitedSignals& signals) {
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    const std::optional<siginfo_t> info = signals.next();
    if (info && info->si_signo != SIGCHLD && info->si_code <= 0) kill(child, info->si_signo);
  }
  return status;
}

/// A pipe through which the sibling tells the folder that it writes into.
class RunFolderNote {
 public:
  RunFolderNote() {
    if (::pipe(ends_.data()) != 0) return;
    ::fcntl(ends_[0], F_SETFD, FD_CLOEXEC);
    ::fcntl(ends_[0], F_SETFL, O_NONBLOCK);
    ::setenv(kRunFolderNote, std::to_string(ends_[1]).c_str(), 1);
  }
  RunFolderNote(const RunFolderNote&) = delete;
  RunFolderNote& operator=(const RunFolderNote&) = delete;
  ~RunFolderNote() {
    ::unsetenv(kRunFolderNote);
    for (const int end : ends_) ::close(end);
  }

  /// The folder; empty if none was told.
  [[nodiscard]] std::string read() const {
    std::array<char, PATH_MAX> text{};
    const ssize_t count = ::read(ends_[0], text.data(), text.size());
    return {text.data(), std::size_t(std::max<ssize_t>(count, 0))};
  }

 private:
  std::array<int, 2> ends_{-1, -1};
};

}  // namespace

fs::path sibling_path(const std::string& name) { return prefix() / "libexec" / "mvtp" / name; }

fs::path shared_file(const std::string& name) { return prefix() / "share" / "mvtp" / name; }

int run_sibling(const std::string& name, int argc, char** argv) {
  const std::string command = argc > 1 ? argv[1] : name;
  const fs::path program = sibling_path(name);
  if (!fs::exists(program)) {
    throw InputError(command, fmt::format("needs {}, which a build without SUMO lacks; build with "
                                          "-DMVTP_WITH_SUMO=ON",
                                          program.string()));
  }
  const AwaitedSignals signals;
  RunFolderNote note;
  const pid_t child = start_child(program, std::vector<std::string>(argv, argv + argc), signals);
  const int status = wait_for(child, signals);

  if (WIFEXITED(status)) return WEXITSTATUS(status);
  const int signal = WTERMSIG(status);
  if (signal == SIGINT || signal == SIGTERM) return kInterrupted;
  const std::string message = fmt::format("the simulation crashed ({})", strsignal(signal));
  const std::string folder = note.read();
  const bool complete = !folder.empty() && complete_crashed_run(folder, message);
  fmt::print(stderr, "mvtp: {}: {}; {}\n", command, message,
             complete ? fmt::format("{} holds what was simulated before", folder)
                      : "it had not got far enough to leave results");
  return kNotAchieved;
}

}  // namespace mvtp
