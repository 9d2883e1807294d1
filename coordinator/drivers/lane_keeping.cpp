#include "coordinator/drivers/lane_keeping.hpp"

#include <algorithm>
#include <utility>

namespace mvtp {

void LaneKeeping::keep(const std::string& id, Reason reason, bool keep) {
  if (keep) {
    kept_[reason].insert(id);
  } else {
    kept_[reason].erase(id);
  }
  show(id);
}

void LaneKeeping::keep_only(std::set<std::string> ids, Reason reason) {
  std::set<std::string>& kept = kept_[reason];
  const std::set<std::string> before = std::exchange(kept, std::move(ids));
  for (const std::string& id : kept) show(id);
  for (const std::string& id : before) {
    if (!kept.contains(id)) show(id);
  }
}

/// Tells the traffic whether there is any reason to keep him.
void LaneKeeping::show(const std::string& id) {
  traffic_.keep_lane(
      id, std::ranges::any_of(kept_, [&](const auto& entry) { return entry.second.contains(id); }));
}

}  // namespace mvtp
