#include "traci_bridge/sumo_process.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <system_error>
#include <thread>

namespace mvtp {
namespace {

constexpr auto kPollInterval = std::chrono::milliseconds(5);
constexpr auto kStartLimit = std::chrono::seconds(60);
constexpr auto kEndLimit = std::chrono::seconds(10);

/// A port of this machine on which nobody listens.
int free_port() {
  const int socket_id = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  const bool found = socket_id >= 0 && bind(socket_id, generic, size) == 0 &&
                     getsockname(socket_id, generic, &size) == 0;
  const int error = errno;
  if (socket_id >= 0) close(socket_id);
  if (!found) throw std::system_error(error, std::generic_category(), "no free port");
  return ntohs(address.sin_port);
}

/// Read off the kernel's table: SUMO would take a trial connection for its client.
bool is_listening(int port) {
  std::array<char, 8> suffix{};
  std::snprintf(suffix.data(), suffix.size(), ":%04X", static_cast<unsigned>(port));
  for (const char* table : {"/proc/net/tcp", "/proc/net/tcp6"}) {
    std::ifstream rows(table);
    std::string row;
    std::string local;
    std::string remote;
    std::string state;
    std::getline(rows, row);
    while (rows >> row >> local >> remote >> state) {
      if (local.ends_with(suffix.data()) && state == "0A") return true;
      std::getline(rows, row);
    }
  }
  return false;
}

/// True once `done` is; false after `limit`.
bool wait_for(const std::function<bool()>& done, std::chrono::seconds limit) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!done()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(kPollInterval);
  }
  return true;
}

/// In the child: the program instead of this one. In a process group of its own, since an interrupt
/// from the terminal is ours to handle; and ends once this process does, however it ends.
[[noreturn]] void become(char** argv, int log, pid_t parent, int failure) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);
  dup2(log, STDOUT_FILENO);
  dup2(log, STDERR_FILENO);
  execvp(argv[0], argv);
  const int error = errno;
  if (write(failure, &error, sizeof(error)) < 0) _exit(126);
  _exit(127);
}

pid_t spawn(std::vector<std::string>& arguments, int log) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);

  std::array<int, 2> failure{};  // closed by a successful exec
  if (pipe2(failure.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe to start it by");
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid == 0) become(argv.data(), log, parent, failure[1]);
  close(failure[1]);
  int error = pid < 0 ? errno : 0;
  if (pid > 0 && read(failure[0], &error, sizeof(error)) > 0) waitpid(pid, nullptr, 0);
  close(failure[0]);
  if (error != 0) {
    throw std::runtime_error(arguments[0] + " cannot be started (" +
                             std::generic_category().message(error) + "); install it");
  }
  return pid;
}

}  // namespace

SumoProcess::SumoProcess(std::vector<std::string> arguments, int log,
                         const InterruptionPoint& point)
    : port_(free_port()) {
  arguments.insert(arguments.end(), {"--remote-port", std::to_string(port_)});
  pid_ = spawn(arguments, log);
  try {
    wait_until_listening(point);
  } catch (...) {
    stop();
    throw;
  }
}

SumoProcess::~SumoProcess() { stop(); }

void SumoProcess::stop() {
  if (pid_ < 0) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
  pid_ = -1;
}

bool SumoProcess::wait() {
  return wait_for([this] { return ended(); }, kEndLimit) && exit_status_ == 0;
}

void SumoProcess::wait_until_listening(const InterruptionPoint& point) {
  const auto done = [&] {
    point();
    return ended() || is_listening(port_);
  };
  const bool in_time = wait_for(done, kStartLimit);
  if (ended()) throw std::runtime_error("it ended at once");
  if (!in_time) throw std::runtime_error("it did not open its port within 60 s");
}

bool SumoProcess::ended() {
  if (pid_ >= 0 && waitpid(pid_, &exit_status_, WNOHANG) == pid_) pid_ = -1;
  return pid_ < 0;
}

}  // namespace mvtp
