#include "coordinator/drivers/lane_keeping.hpp"

namespace mvtp {

void LaneKeeping::keep(const std::string& id, Reason reason, bool keep) {
  const auto known = reasons_.find(id);
  if (keep) {
    reasons_[id].insert(reason);
  } else if (known != reasons_.end()) {
    known->second.erase(reason);
    if (known->second.empty()) reasons_.erase(known);
  }
  traffic_.keep_lane(id, reasons_.contains(id));
}

}  // namespace mvtp
