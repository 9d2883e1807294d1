#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <random>
#include <utility>

namespace mvtp {

/// Numbers by chance, the same on every machine.
class WorldDice {
 public:
  explicit WorldDice(std::uint64_t seed) : engine_(seed) {}
  /// In [0, 1).
  double share() { return double(engine_() >> 11U) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * share(); }
  bool happens(double probability) { return share() < probability; }

 private:
  std::mt19937_64 engine_;
};

/// How long messages are under way, and how many never arrive.
struct AirQuality {
  double delay = 0.0;   ///< in the mean [s]
  double jitter = 0.0;  ///< the delay varies by this share of it, evenly
  double loss = 0.0;    ///< share of the messages
};

/// One direction of a radio link: messages arrive in order, late by chance, or not at all.
template <class Message>
class Air {
 public:
  void send(Message message, double now, const AirQuality& quality, WorldDice& dice) {
    const double delay = quality.delay * dice.between(1.0 - quality.jitter, 1.0 + quality.jitter);
    last_ = std::max(last_, now + delay);
    if (!dice.happens(quality.loss)) under_way_.push_back({last_, std::move(message)});
  }

  /// Hands the messages that have arrived to `take`.
  template <class Take>
  void deliver(double now, const Take& take) {
    for (; !under_way_.empty() && under_way_.front().time <= now; under_way_.pop_front()) {
      take(under_way_.front().message);
    }
  }

 private:
  struct Item {
    double time;
    Message message;
  };
  std::deque<Item> under_way_;
  double last_ = 0.0;
};

}  // namespace mvtp
