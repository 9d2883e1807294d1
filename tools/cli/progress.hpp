#pragma once

#include <chrono>
#include <string>
#include <thread>

namespace mvtp {

/// "3 min left", for work of which `fraction` in (0, 1] took so many seconds; empty at the end.
[[nodiscard]] std::string time_left(double seconds, double fraction);

/// Tells on stderr how far long work has come, and how long the rest will take if it goes on like
/// that: a bar that redraws itself on a terminal, else one line per 10 %; nothing at all if quiet.
class Progress {
 public:
  Progress(std::string label, bool quiet);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// Ends the line of the bar, so that the next message starts on its own.
  ~Progress();

  /// @param fraction of the work done, in [0, 1]; going back is ignored.
  /// @param note what else is worth saying, e.g. "412 vehicles".
  void update(double fraction, const std::string& note = "");

 private:
  using Clock = std::chrono::steady_clock;

  void draw_bar(double fraction, const std::string& note);

  std::string label_;
  bool quiet_;
  bool on_terminal_;
  Clock::time_point start_ = Clock::now();
  int tenths_ = 0;         ///< lines printed so far, or the bar is unfinished
  std::size_t width_ = 0;  ///< of the bar's last line, to wipe it
  Clock::time_point next_draw_{};
};

/// The same for work that ends at a time limit at the latest: it tells from a thread of its own how
/// much of that time has passed, until it is destroyed.
class TimeProgress {
 public:
  /// @param seconds  the time limit; work that is done sooner than a tenth of it tells nothing.
  TimeProgress(const std::string& label, double seconds, bool quiet);

 private:
  std::jthread thread_;
};

}  // namespace mvtp
