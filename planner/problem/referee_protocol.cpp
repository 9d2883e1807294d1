#include "planner/problem/referee_protocol.hpp"

#include <algorithm>

namespace mvtp::referee {

void Protocol::add(Rule rule, std::size_t subject, std::size_t object, std::size_t step,
                   double when, double amount, double turn) {
  const auto [open, is_new] = open_.try_emplace({rule, subject, object}, entries_.size());
  if (!is_new && entries_[open->second].last_step + 1 >= step) {
    Entry& entry = entries_[open->second];
    entry.last_step = step;
    entry.amount = std::max(entry.amount, amount);
    entry.turn = std::max(entry.turn, turn);
    return;
  }
  open->second = entries_.size();
  entries_.push_back({rule, subject, object, step, when, amount, turn});
}

void Protocol::prolong(Rule rule, std::size_t subject, std::size_t object, std::size_t step) {
  const auto open = open_.find({rule, subject, object});
  if (open == open_.end()) return;
  Entry& entry = entries_[open->second];
  if (entry.last_step + 1 == step) entry.last_step = step;
}

std::vector<Protocol::Entry> Protocol::entries() const {
  std::vector<Entry> sorted = entries_;
  const auto key = [](const Entry& e) { return std::tuple(e.rule, e.subject, e.object, e.when); };
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](const Entry& a, const Entry& b) { return key(a) < key(b); });
  return sorted;
}

}  // namespace mvtp::referee
