#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <string>

#include "planner/problem/instance.hpp"

namespace mvtp {

/// Numbers that are the same on every standard library.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : rng_(seed) {}

  [[nodiscard]] double in(double low, double high) {
    return low + (high - low) * double(rng_() >> 11U) * 0x1p-53;
  }
  /// 0, 1, ..., n - 1.
  [[nodiscard]] int below(int n) { return int(rng_() % std::uint64_t(n)); }
  [[nodiscard]] bool chance(double probability) { return in(0, 1) < probability; }

 private:
  std::mt19937_64 rng_;
};

/// An instance that check_instance() has nothing against: a map of 12 to 40 m with 0 to 12 circles
/// and 0 to 2 polygons, and 0 to 8 robots of one preset or all different; either bounds rule; steps
/// of 0.5, 1 or 2.118 s. Some robots stand at their goal, start on another's goal, or touch a
/// neighbour. Fewer robots where there is no room for more.
[[nodiscard]] Instance small_instance(std::uint64_t seed);

/// The instance seen in a mirror: y becomes height - y, and yaw -yaw.
[[nodiscard]] Instance mirrored(const Instance& instance);

/// The instance without whatever it `fails` without as well: robots, circles, polygons, one by one.
[[nodiscard]] Instance shrunk(Instance instance, const std::function<bool(const Instance&)>& fails);

/// The instance as the text of its file.
[[nodiscard]] std::string yaml_of(const Instance& instance);

}  // namespace mvtp
