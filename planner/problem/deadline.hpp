#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>

namespace mvtp {

/// A point in time after which a search has to stop, or sooner if somebody says so; the only clock
/// that the planner knows.
class Deadline {
 public:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] static Deadline in(double seconds) {
    // Bounded, so that a huge limit cannot overflow the clock's representation.
    const double bounded = std::clamp(seconds, 0.0, 1e9);
    return Deadline(Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                       std::chrono::duration<double>(bounded)));
  }
  [[nodiscard]] static Deadline never() { return in(1e9); }

  [[nodiscard]] bool expired() const {
    return (stop_ != nullptr && stop_->load(std::memory_order_relaxed)) || Clock::now() >= end_;
  }
  [[nodiscard]] double remaining() const {
    return std::chrono::duration<double>(end_ - Clock::now()).count();
  }
  /// The earlier of this deadline and `seconds` from now.
  [[nodiscard]] Deadline within(double seconds) const {
    return Deadline(std::min(end_, in(seconds).end_), stop_);
  }
  /// This deadline, or as soon as `stop` is true. @param stop  outlives it
  [[nodiscard]] Deadline or_when(const std::atomic<bool>& stop) const {
    return Deadline(end_, &stop);
  }

 private:
  explicit Deadline(Clock::time_point end, const std::atomic<bool>* stop = nullptr)
      : end_(end), stop_(stop) {}
  Clock::time_point end_;
  const std::atomic<bool>* stop_;
};

}  // namespace mvtp
