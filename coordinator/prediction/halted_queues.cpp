#include "coordinator/prediction/halted_queues.hpp"

#include <algorithm>

namespace mvtp {

HaltedQueues::HaltedQueues(std::vector<HaltedDriver> drivers) {
  constexpr double kQueueGap = 10.0;  // [m] between two who stand in one queue
  for (HaltedDriver& d : drivers) by_lane_[d.lane].push_back(d);
  for (auto& [lane, queue] : by_lane_) {
    std::ranges::sort(queue, {}, &HaltedDriver::tail);
    for (std::size_t i = queue.size() - 1; i-- > 0;) {
      const HaltedDriver& ahead = queue[i + 1];
      if (ahead.tail - queue[i].front < kQueueGap) {
        queue[i].stands = std::max(queue[i].stands, ahead.stands);
      }
    }
  }
}

const HaltedDriver* HaltedQueues::first_ahead(int lane, double position) const {
  const auto queue = by_lane_.find(lane);
  if (queue == by_lane_.end()) return nullptr;
  const auto ahead = std::ranges::lower_bound(queue->second, position, {}, &HaltedDriver::tail);
  return ahead == queue->second.end() ? nullptr : &*ahead;
}

}  // namespace mvtp
