#pragma once

#include <algorithm>
#include <cmath>

#include "planner/problem/draws.hpp"

namespace mvtp {

/// First-order autoregressive noise with standard deviation 1, cut off at a most.
class Noise {
 public:
  /// @param memory  share of the last value in the next one, 0 ... 1.
  /// @param most    in standard deviations.
  Noise(double memory, double most, Draws& draws) : memory_(memory), most_(most) {
    value_ = normal(draws);
  }

  /// The next value.
  void advance(Draws& draws) {
    value_ = memory_ * value_ + std::sqrt(1.0 - memory_ * memory_) * normal(draws);
  }
  [[nodiscard]] double value() const { return std::clamp(value_, -most_, most_); }

 private:
  /// The sum of twelve even draws: variance 1, and the same bits on every machine.
  static double normal(Draws& draws) {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += draws.share();
    return sum;
  }

  double memory_;
  double most_;
  double value_ = 0.0;
};

}  // namespace mvtp
