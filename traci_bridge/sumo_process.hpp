#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "planner/problem/interruption.hpp"

namespace mvtp {

/// SUMO as a program of its own, listening on a port of this machine; killed at the latest with
/// this object.
class SumoProcess {
 public:
  /// Starts `arguments` (the program first), its output going to the file descriptor `log`, and
  /// waits until it listens. Throws std::runtime_error if it ends before, or does not start.
  /// @param point  called while it waits
  SumoProcess(std::vector<std::string> arguments, int log,
              const InterruptionPoint& point = never_interrupted);
  SumoProcess(const SumoProcess&) = delete;
  SumoProcess& operator=(const SumoProcess&) = delete;
  ~SumoProcess();

  [[nodiscard]] int port() const { return port_; }
  /// Waits for its end, 10 s at most. True if it ended, and well.
  bool wait();

 private:
  void wait_until_listening(const InterruptionPoint& point);
  void stop();
  /// Has it ended? Then exit_status_ is set.
  bool ended();

  int port_;
  pid_t pid_ = -1;  ///< -1 once it has ended
  int exit_status_ = 0;
};

}  // namespace mvtp
