#include "coordinator/junctions/stagnation.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "planner/problem/draws.hpp"

namespace mvtp {

std::vector<std::int64_t> Stagnation::duplicates(std::span<const std::vector<std::int64_t>> groups,
                                                 std::map<std::int64_t, InertialState> now,
                                                 std::uint64_t seed) {
  const auto stands = [&](std::int64_t key) {
    const auto before = last_.find(key);
    const InertialState& state = now.at(key);
    return state.v == 0.0 && before != last_.end() && before->second == state;
  };
  std::vector<std::int64_t> upset;
  for (const std::vector<std::int64_t>& group : groups) {
    std::vector<std::int64_t> there;
    std::ranges::copy_if(group, std::back_inserter(there),
                         [&](std::int64_t key) { return now.contains(key); });
    if (there.size() < 2 || !std::ranges::all_of(there, stands)) continue;
    Draws draws(seed + std::uint64_t(there.front()));
    draws.shuffle(there);
    upset.insert(upset.begin(), there.begin(), there.end());
  }
  last_ = std::move(now);
  return upset;
}

}  // namespace mvtp
