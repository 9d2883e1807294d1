#pragma once

#include <algorithm>
#include <chrono>

namespace mvtp {

/// A point in time after which a search has to stop; the only clock that the planner knows.
class Deadline {
 public:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] static Deadline in(double seconds) {
    // Bounded, so that a huge limit cannot overflow the clock's representation.
    const double bounded = std::clamp(seconds, 0.0, 1e9);
    return Deadline(Clock::now() +
                    std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(bounded)));
  }
  [[nodiscard]] static Deadline never() { return in(1e9); }

  [[nodiscard]] bool expired() const { return Clock::now() >= end_; }
  [[nodiscard]] double remaining() const {
    return std::chrono::duration<double>(end_ - Clock::now()).count();
  }
  /// The earlier of this deadline and `seconds` from now.
  [[nodiscard]] Deadline within(double seconds) const {
    return Deadline(std::min(end_, in(seconds).end_));
  }

 private:
  explicit Deadline(Clock::time_point end) : end_(end) {}
  Clock::time_point end_;
};

}  // namespace mvtp
