#pragma once

#include <cstdint>
#include <initializer_list>
#include <random>

#include "planner/problem/draws.hpp"

namespace mvtp {

/// Draws that depend on any number of words.
class Dice : public Draws {
 public:
  /// @param words what the numbers depend on; the seed may be split by low_word() and high_word().
  Dice(std::initializer_list<std::uint32_t> words) : Dice(std::seed_seq(words)) {}

 private:
  explicit Dice(std::seed_seq&& sequence) : Draws(sequence) {}
};

template <class Integer>
[[nodiscard]] std::uint32_t low_word(Integer value) {
  return std::uint32_t(std::uint64_t(value) & 0xffffffffU);
}
[[nodiscard]] inline std::uint32_t high_word(std::uint64_t value) {
  return std::uint32_t(value >> 32U);
}

}  // namespace mvtp
