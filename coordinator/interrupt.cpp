#include "coordinator/interrupt.hpp"

#include <unistd.h>

#include <csignal>
#include <initializer_list>

namespace mvtp {
namespace {

constexpr int kExitCode = 130;

volatile std::sig_atomic_t signals = 0;  // handlers reach nothing else

}  // namespace

void note_interrupts() {
  for (const int signal : {SIGINT, SIGTERM}) {
    std::signal(signal, [](int) {
      if (signals != 0) _exit(kExitCode);
      signals = 1;
    });
  }
}

bool interrupted() { return signals != 0; }

}  // namespace mvtp
