#include "tools/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace mvtp {

Progress::Progress(std::string label, bool quiet)
    : label_(std::move(label)), quiet_(quiet), on_terminal_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (width_ > 0) fmt::print(stderr, "\n");
}

void Progress::update(double fraction, const std::string& note) {
  if (quiet_ || !(fraction >= 0.0)) return;
  fraction = std::min(fraction, 1.0);
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

}  // namespace mvtp
