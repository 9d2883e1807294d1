#include "tools/sibling.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>

#include "planner/problem/input_error.hpp"
#include "tools/program.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

sigset_t awaited_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGCHLD}) sigaddset(&set, signal);
  return set;
}

/// Starts the program with the signal mask that this process had before.
pid_t spawn(const fs::path& program, char** argv, const sigset_t& mask) {
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setsigmask(&attributes, &mask);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  pid_t child = 0;
  const int error = posix_spawn(&child, program.c_str(), nullptr, &attributes, argv, environ);
  posix_spawnattr_destroy(&attributes);
  if (error != 0) {
    throw InputError(program.string(),
                     fmt::format("cannot be run: {}; install mvtp again", std::strerror(error)));
  }
  return child;
}

/// Waits for the child's end. A signal from a terminal reaches the whole process group and so the
/// child itself; one that somebody sent to this process alone is passed on.
int wait_for(pid_t child, const sigset_t& signals) {
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    siginfo_t info{};
    const int signal = sigwaitinfo(&signals, &info);
    if ((signal == SIGINT || signal == SIGTERM) && info.si_code <= 0) kill(child, signal);
  }
  return status;
}

}  // namespace

fs::path sibling_path(const std::string& name) {
  return fs::read_symlink("/proc/self/exe").parent_path().parent_path() / "libexec" / "mvtp" / name;
}

int run_sibling(const std::string& name, int argc, char** argv) {
  const std::string command = argc > 1 ? argv[1] : name;
  const fs::path program = sibling_path(name);
  if (!fs::exists(program)) {
    throw InputError(command, fmt::format("needs {}, which a build without SUMO lacks; build with "
                                          "-DMVTP_WITH_SUMO=ON",
                                          program.string()));
  }
  const sigset_t signals = awaited_signals();
  sigset_t before;
  sigprocmask(SIG_BLOCK, &signals, &before);
  const int status = wait_for(spawn(program, argv, before), signals);
  sigprocmask(SIG_SETMASK, &before, nullptr);

  if (WIFEXITED(status)) return WEXITSTATUS(status);
  const int signal = WTERMSIG(status);
  if (signal == SIGINT || signal == SIGTERM) return kInterrupted;
  fmt::print(stderr,
             "mvtp: {}: the simulation crashed ({}); the output holds what was finished before\n",
             command, strsignal(signal));
  return kNotAchieved;
}

}  // namespace mvtp
