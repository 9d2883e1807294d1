#pragma once

#include <atomic>

namespace mvtp {

/// From now on SIGINT and SIGTERM end this program at once, with the exit code kInterrupted; what
/// is being written is finished first (see write_text_file()). Those who wait for the signals
/// themselves (AwaitedSignals) are not affected.
void end_on_signals();

/// While it lives, the first of these signals is only noted: whoever works looks at it and ends
/// with what there is. One that comes a second later ends the program. One object at a time.
class NotedInterrupt {
 public:
  NotedInterrupt();
  NotedInterrupt(const NotedInterrupt&) = delete;
  NotedInterrupt& operator=(const NotedInterrupt&) = delete;
  ~NotedInterrupt();

  [[nodiscard]] const std::atomic<bool>& seen() const;
};

}  // namespace mvtp
