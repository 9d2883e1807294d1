#include "planner/road/passing_order.hpp"

#include <algorithm>

namespace mvtp {

PassingOrder joined(PassingOrder order, const PassingOrder& more) {
  order.insert(order.end(), more.begin(), more.end());
  return order;
}

void PassingOrders::move_earlier(PassingOrder& order, std::size_t i, int places,
                                 int followers) const {
  const std::int64_t moved = order[i];
  std::size_t to = i;
  while (to > 0 && places > 0 && !leads(order[to - 1], moved)) --to, --places;
  std::rotate(order.begin() + std::ptrdiff_t(to), order.begin() + std::ptrdiff_t(i),
              order.begin() + std::ptrdiff_t(i) + 1);
  for (std::size_t j = i + 1; j < order.size() && followers > 0; ++j) {
    if (!leads(moved, order[j])) continue;
    ++to;
    --followers;
    std::rotate(order.begin() + std::ptrdiff_t(to), order.begin() + std::ptrdiff_t(j),
                order.begin() + std::ptrdiff_t(j) + 1);
  }
}

void PassingOrders::move_later(PassingOrder& order, std::size_t i, int places) const {
  const std::int64_t moved = order[i];
  while (i + 1 < order.size() && places-- > 0 && !leads(moved, order[i + 1])) {
    std::swap(order[i], order[i + 1]);
    ++i;
  }
}

bool PassingOrders::move_to_front(PassingOrder& order, std::size_t i) const {
  const std::int64_t moved = order[i];
  std::size_t to = 0;
  for (std::size_t j = 0; j < i; ++j) {
    if (leads(order[j], moved)) to = j + 1;
  }
  if (to == i) return move_leader_to_front(order, to);
  std::rotate(order.begin() + std::ptrdiff_t(to), order.begin() + std::ptrdiff_t(i),
              order.begin() + std::ptrdiff_t(i) + 1);
  return true;
}

/// A vehicle right behind its leader cannot pass it: the leader has to come earlier first.
bool PassingOrders::move_leader_to_front(PassingOrder& order, std::size_t follower) const {
  return follower > 0 && leads(order[follower - 1], order[follower]) &&
         move_to_front(order, follower - 1);
}

PassingOrder PassingOrders::in_lane_order(const PassingOrder& order) const {
  const std::size_t n = order.size();
  std::vector<std::size_t> index;
  for (const std::int64_t key : order) index.push_back(pairs_.index(key));
  std::vector<int> leaders(n, 0);  // that are not sorted yet
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) leaders[i] += pairs_.leads(index[j], index[i]) ? 1 : 0;
  }
  PassingOrder sorted;
  std::vector<bool> taken(n, false);
  while (sorted.size() < n) {
    std::size_t next = 0;
    while (next < n && (taken[next] || leaders[next] > 0)) ++next;
    // Leaders in a circle: one of them has to be the first.
    if (next == n) next = std::size_t(std::ranges::find(taken, false) - taken.begin());
    taken[next] = true;
    sorted.push_back(order[next]);
    for (std::size_t i = 0; i < n; ++i) leaders[i] -= pairs_.leads(index[next], index[i]) ? 1 : 0;
  }
  return sorted;
}

}  // namespace mvtp
