#pragma once

#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <utility>
#include <vector>

namespace mvtp {

/// Draws by chance, the same on every machine: std::mt19937_64 is specified to the bit, the
/// standard's distributions are not.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : engine_(seed) {}
  explicit Draws(std::seed_seq& seed) : engine_(seed) {}

  /// From `low` to `high`, both included.
  [[nodiscard]] int between(int low, int high) {
    const auto count = std::uint64_t(std::int64_t(high) - low + 1);
    const std::uint64_t limit = std::numeric_limits<std::uint64_t>::max() / count * count;
    std::uint64_t drawn = engine_();
    while (drawn >= limit) drawn = engine_();
    return int(low + std::int64_t(drawn % count));
  }

  /// In [0, 1).
  [[nodiscard]] double share() { return double(engine_() >> 11U) * 0x1p-53; }

  /// A place in `weights`, each as likely as its weight is large. @pre their sum is positive
  [[nodiscard]] std::size_t weighted(std::span<const double> weights) {
    double sum = 0.0;
    for (const double w : weights) sum += w;
    double left = share() * sum;
    std::size_t last = 0;  // rounding may leave a little behind the last one
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (weights[i] <= 0.0) continue;
      last = i;
      left -= weights[i];
      if (left < 0.0) break;
    }
    return last;
  }

  /// Brings the values into any order.
  template <class Value>
  void shuffle(std::vector<Value>& values) {
    for (std::size_t i = values.size(); i > 1; --i) {
      std::swap(values[i - 1], values[std::size_t(between(0, int(i) - 1))]);
    }
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace mvtp
