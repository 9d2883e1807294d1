#include "tools/sibling.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <csignal>
#include <cstring>
#include <vector>

#include "planner/problem/input_error.hpp"
#include "tools/child_process.hpp"
#include "tools/program.hpp"

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
  const int status =
      wait_for(start_child(program, std::vector<std::string>(argv, argv + argc), signals), signals);

  if (WIFEXITED(status)) return WEXITSTATUS(status);
  const int signal = WTERMSIG(status);
  if (signal == SIGINT || signal == SIGTERM) return kInterrupted;
  fmt::print(stderr,
             "mvtp: {}: the simulation crashed ({}); the output holds what was finished before\n",
             command, strsignal(signal));
  return kNotAchieved;
}

}  // namespace mvtp
