#include "tools/cli/interrupt.hpp"

#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <ctime>

#include "tools/cli/program.hpp"

namespace mvtp {
namespace {

// A signal handler knows nothing but what is global.
std::atomic<bool> noting = false;
std::atomic<bool> noted = false;
std::atomic<std::int64_t> noted_at = 0;  // [ns]
static_assert(std::atomic<bool>::is_always_lock_free);
static_assert(std::atomic<std::int64_t>::is_always_lock_free);

/// A signal to the whole process group may arrive twice within a moment: that is one wish to end.
constexpr std::int64_t kSameWish = 1'000'000'000;  // [ns]

std::int64_t now() {
  timespec time{};
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  return std::int64_t(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
}

void handle(int) {
  if (!noting) ::_exit(kInterrupted);
  if (!noted.exchange(true)) {
    noted_at = now();
  } else if (now() - noted_at > kSameWish) {
    ::_exit(kInterrupted);
  }
}

}  // namespace

void end_on_signals() {
  struct sigaction action {};
  action.sa_handler = handle;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction before {};
    ::sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) ::sigaction(signal, &action, nullptr);  // as nohup wants it
  }
}

NotedInterrupt::NotedInterrupt() {
  noted = false;
  noting = true;
}

NotedInterrupt::~NotedInterrupt() { noting = false; }

const std::atomic<bool>& NotedInterrupt::seen() const { return noted; }

}  // namespace mvtp
