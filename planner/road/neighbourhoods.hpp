#pragma once

#include <cstddef>
#include <vector>

#include "planner/problem/draws.hpp"
#include "planner/road/passing_order.hpp"
#include "planner/road/profile_planner.hpp"

namespace mvtp {

/// The vehicles that large neighbourhood search plans anew together.
class Neighbourhoods {
 public:
  using Entry = JointPlan::Entry;

  explicit Neighbourhoods(const RoadPairs& pairs) : pairs_(pairs), orders_(pairs) {}

  /// A vehicle with some of its followers, and behind them another one that it meets, with some of
  /// its own: who passes later needs room behind it.
  [[nodiscard]] PassingOrder around(const std::vector<Entry>& entries, std::size_t first,
                                    Draws& draws) const;

 private:
  void add_with_followers(const std::vector<Entry>& entries, std::size_t i, int followers,
                          PassingOrder& chosen) const;
  /// Would the other one be where this one is, had either been a few seconds earlier or later?
  [[nodiscard]] bool meet_soon(std::size_t own, const SpeedProfile& t, const Entry& other) const;

  const RoadPairs& pairs_;
  PassingOrders orders_;
};

}  // namespace mvtp
