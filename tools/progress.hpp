#pragma once

#include <chrono>
#include <string>

namespace mvtp {

/// Does Progress say when the work will be done, as far as can be told?
enum class TimeLeft { kHidden, kShown };

/// "3 min left", for work of which `fraction` in (0, 1] took so many seconds; empty at the end.
[[nodiscard]] std::string time_left(double seconds, double fraction);

/// Tells on stderr how far long work has come: a bar that redraws itself on a terminal, else one
/// line per 10 %, and nothing at all if quiet.
class Progress {
 public:
  Progress(std::string label, bool quiet, TimeLeft time_left = TimeLeft::kHidden);
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
  TimeLeft time_left_;
  Clock::time_point start_ = Clock::now();
  int tenths_ = 0;         ///< lines printed so far, or the bar is unfinished
  std::size_t width_ = 0;  ///< of the bar's last line, to wipe it
  Clock::time_point next_draw_{};
};

}  // namespace mvtp
