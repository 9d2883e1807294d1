#pragma once

#include <cstdint>
#include <initializer_list>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace mvtp {

/// Whole numbers by chance, the same on every machine: std::seed_seq and std::mt19937_64 are
/// specified to the bit, the standard's distributions are not.
class Dice {
 public:
  /// @param words what the numbers depend on; the seed may be split by low_word() and high_word().
  Dice(std::initializer_list<std::uint32_t> words) {
    std::seed_seq sequence(words);
    engine_.seed(sequence);
  }

  /// From `low` to `high`, both included.
  [[nodiscard]] int between(int low, int high) {
    const auto count = std::uint64_t(std::int64_t(high) - low + 1);
    const std::uint64_t limit = std::numeric_limits<std::uint64_t>::max() / count * count;
    std::uint64_t drawn = engine_();
    while (drawn >= limit) drawn = engine_();
    return int(low + std::int64_t(drawn % count));
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

template <class Integer>
[[nodiscard]] std::uint32_t low_word(Integer value) {
  return std::uint32_t(value & 0xffffffffU);
}
[[nodiscard]] inline std::uint32_t high_word(std::uint64_t value) {
  return std::uint32_t(value >> 32U);
}

}  // namespace mvtp
