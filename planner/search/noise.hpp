#pragma once

#include <cstdint>

namespace mvtp {

/// A number in [0, 1) that depends on all arguments and on nothing else.
[[nodiscard]] inline double noise(std::uint64_t seed, std::uint64_t a, std::uint64_t b,
                                  std::uint64_t c) {
  std::uint64_t z =
      seed ^ (a * 0x9e3779b97f4a7c15U) ^ (b * 0xbf58476d1ce4e5b9U) ^ (c * 0x94d049bb133111ebU);
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
  return double((z ^ (z >> 31U)) >> 11U) * 0x1p-53;
}

}  // namespace mvtp
