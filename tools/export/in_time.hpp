#pragma once

#include <algorithm>
#include <vector>

#include "tools/export/recording.hpp"

namespace mvtp {

struct TimedState {
  const RecordedVehicle* vehicle;
  const RecordedState* state;
};

/// All states, those of one time in the order of the vehicles.
[[nodiscard]] inline std::vector<TimedState> in_order_of_time(const Recording& recording) {
  std::vector<TimedState> all;
  for (const RecordedVehicle& vehicle : recording.vehicles) {
    for (const RecordedState& state : vehicle.states) all.push_back({&vehicle, &state});
  }
  std::ranges::stable_sort(all, {}, [](const TimedState& entry) { return entry.state->time; });
  return all;
}

}  // namespace mvtp
