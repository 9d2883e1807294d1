#include "tools/cli/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <utility>

namespace mvtp {

std::string time_left(double seconds, double fraction) {
  if (!(fraction > 0.0) || fraction >= 1.0) return {};
  const double left = seconds * (1.0 - fraction) / fraction;
  if (left < 90.0) return fmt::format("{:.0f} s left", std::ceil(left));
  if (left < 90.0 * 60.0) return fmt::format("{:.0f} min left", left / 60.0);
  return fmt::format("{:.1f} h left", left / 3600.0);
}

Progress::Progress(std::string label, bool quiet)
    : label_(std::move(label)), quiet_(quiet), on_terminal_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (width_ > 0) fmt::print(stderr, "\n");
}

void Progress::update(double fraction, const std::string& what) {
  if (quiet_ || !(fraction >= 0.0)) return;
  fraction = std::min(fraction, 1.0);
  const std::chrono::duration<double> elapsed = Clock::now() - start_;
  const std::string left = time_left(elapsed.count(), fraction);
  const std::string note = left + (left.empty() || what.empty() ? "" : ", ") + what;
  if (on_terminal_) {
    draw_bar(fraction, note);
    return;
  }
  const int tenths = static_cast<int>(std::floor(10.0 * fraction + 1e-9));
  if (tenths <= tenths_) return;
  tenths_ = tenths;
  fmt::print(stderr, "{}: {} %{}{}\n", label_, 10 * tenths, note.empty() ? "" : ", ", note);
}

void Progress::draw_bar(double fraction, const std::string& note) {
  const Clock::time_point now = Clock::now();
  if (now < next_draw_ && fraction < 1.0) return;
  next_draw_ = now + std::chrono::milliseconds(100);
  constexpr int kCells = 30;
  const auto full = static_cast<std::size_t>(std::lround(kCells * fraction));
  const std::string line = fmt::format("{} [{}{}] {:3.0f} % {}", label_, std::string(full, '#'),
                                       std::string(kCells - full, '.'), 100.0 * fraction, note);
  fmt::print(stderr, "\r{:<{}}", line, width_);
  std::fflush(stderr);
  width_ = line.size();
}

TimeProgress::TimeProgress(const std::string& label, double seconds, bool quiet) {
  if (quiet) return;
  thread_ = std::jthread([label, seconds](const std::stop_token& stop) {
    const auto start = std::chrono::steady_clock::now();
    Progress progress(label, false);
    std::mutex mutex;
    std::condition_variable_any stopped;
    std::unique_lock lock(mutex);
    for (double fraction = 0.0; fraction < 1.0 && !stop.stop_requested();) {
      stopped.wait_for(lock, stop, std::chrono::milliseconds(100), [] { return false; });
      fraction = std::chrono::duration<double>(std::chrono::steady_clock::now() - start) /
                 std::chrono::duration<double>(seconds);
      if (fraction >= 0.1 && !stop.stop_requested()) progress.update(std::min(fraction, 0.99));
    }
  });
}

}  // namespace mvtp
