#pragma once

#include <unordered_map>
#include <vector>

namespace mvtp {

/// A driver who stands on the road, and for how long he is expected to.
struct HaltedDriver {
  int lane = -1;
  double front = 0.0;   ///< [m] from the start of the lane
  double tail = 0.0;    ///< [m] likewise; < 0: still on the lane before
  double stands = 0.0;  ///< [s] still
};

/// Who stands on which lane; nobody in a queue goes on before the one ahead of him.
class HaltedQueues {
 public:
  HaltedQueues() = default;
  explicit HaltedQueues(std::vector<HaltedDriver> drivers);

  /// The first whose tail is at `position` [m] or further ahead on the lane; nullptr if there is
  /// none.
  [[nodiscard]] const HaltedDriver* first_ahead(int lane, double position) const;

 private:
  std::unordered_map<int, std::vector<HaltedDriver>> by_lane_;  ///< the hindmost first
};

}  // namespace mvtp
