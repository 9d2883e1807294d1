#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "planner/road/road_contact.hpp"

namespace mvtp {

/// Keys of vehicles, the highest priority first.
using PassingOrder = std::vector<std::int64_t>;

/// One order behind the other.
[[nodiscard]] PassingOrder joined(PassingOrder order, const PassingOrder& more);

/// Changes to orders of priority in which nobody comes before those it follows on its lane
/// (RoadPairs::leads()).
class PassingOrders {
 public:
  explicit PassingOrders(const RoadPairs& pairs) : pairs_(pairs) {}

  /// Must `a` stay before `b` in every order?
  [[nodiscard]] bool leads(std::int64_t a, std::int64_t b) const {
    return pairs_.leads(pairs_.index(a), pairs_.index(b));
  }
  /// Number i up to so many places earlier, and behind it up to so many of its followers.
  void move_earlier(PassingOrder& order, std::size_t i, int places, int followers) const;
  /// Number i up to so many places later.
  void move_later(PassingOrder& order, std::size_t i, int places) const;
  /// To the first place behind its own lane leaders; false if it is there already.
  bool move_to_front(PassingOrder& order, std::size_t i) const;
  /// The order in which nobody comes before its lane leaders: whoever does waits for them.
  [[nodiscard]] PassingOrder in_lane_order(const PassingOrder& order) const;

 private:
  bool move_leader_to_front(PassingOrder& order, std::size_t follower) const;

  const RoadPairs& pairs_;
};

}  // namespace mvtp
