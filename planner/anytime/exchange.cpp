#include "planner/anytime/exchange.hpp"

#include <algorithm>

namespace mvtp {

Exchange::Exchange(int searchers, int goal)
    : goal_(goal), slots_(std::size_t(searchers)), barrier_(searchers, Completion{this}) {}

bool Exchange::meet(int searcher, ConflictFreePlan& plan, bool finished) {
  slots_[std::size_t(searcher)] = {&plan, finished};
  barrier_.arrive_and_wait();
  const bool ended = ended_;
  if (best_.better_than(plan)) plan = best_;
  barrier_.arrive_and_wait();  // nobody compares again while someone still reads
  return ended;
}

void Exchange::compare() noexcept {
  for (const Slot& slot : slots_) {
    if (slot.plan != nullptr && slot.plan->better_than(best_)) best_ = *slot.plan;
  }
  ended_ = best_.makespan <= goal_ || std::ranges::all_of(slots_, &Slot::finished);
}

}  // namespace mvtp
