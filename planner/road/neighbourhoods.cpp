#include "planner/road/neighbourhoods.hpp"

#include <algorithm>

namespace mvtp {

PassingOrder Neighbourhoods::around(const std::vector<Entry>& entries, std::size_t first,
                                    Draws& draws) const {
  constexpr int kFollowers = 4;
  const std::size_t own = pairs_.index(entries[first].key);
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const std::size_t other = pairs_.index(entries[i].key);
    if (i == first || pairs_.leads(own, other) || pairs_.leads(other, own)) continue;
    if (meet_soon(own, *entries[first].profile, entries[i])) near.push_back(i);
  }
  PassingOrder chosen;
  add_with_followers(entries, first, draws.between(0, kFollowers), chosen);
  if (!near.empty()) {
    const std::size_t other = near[std::size_t(draws.between(0, int(near.size()) - 1))];
    add_with_followers(entries, other, draws.between(0, kFollowers), chosen);
  }
  return orders_.in_lane_order(chosen);
}

void Neighbourhoods::add_with_followers(const std::vector<Entry>& entries, std::size_t i,
                                        int followers, PassingOrder& chosen) const {
  const std::int64_t leader = entries[i].key;
  if (std::ranges::find(chosen, leader) == chosen.end()) chosen.push_back(leader);
  for (; i < entries.size() && followers > 0; ++i) {
    if (!orders_.leads(leader, entries[i].key)) continue;
    --followers;
    const bool known = std::ranges::find(chosen, entries[i].key) != chosen.end();
    if (!known) chosen.push_back(entries[i].key);
  }
}

bool Neighbourhoods::meet_soon(std::size_t own, const SpeedProfile& t, const Entry& other) const {
  constexpr double kSoon = 4.0;  // [s]
  const ContactView contact = pairs_.between(own, pairs_.index(other.key));
  if (contact.contact->never()) return false;
  const auto few = std::int64_t(kSoon / pairs_.scene().grid.dt);
  const std::int64_t last = std::min(t.end() - 1, other.profile->end() - 1 + few);
  for (std::int64_t k = pairs_.scene().step; k <= last; k += few) {
    const std::int64_t until = std::min(k + few, t.end() - 1);
    const std::int64_t from = std::max(pairs_.scene().step, k - few);
    if (from >= other.profile->end()) return false;
    const std::int64_t to = std::min(until + few, other.profile->end() - 1);
    if (contact.table().reaches(t.at(k).s, t.at(until).s, other.profile->at(from).s,
                                other.profile->at(to).s)) {
      return true;
    }
  }
  return false;
}

}  // namespace mvtp
