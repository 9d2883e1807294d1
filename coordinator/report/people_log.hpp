#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "coordinator/simulation/simulation.hpp"

namespace mvtp {

/// What people on foot did in a run.
struct PeopleFigures {
  std::int64_t walked = 0;  ///< people seen on foot
  double wait_mean = 0.0;   ///< [s] that one stood, at crossings or before others
  double wait_p95 = 0.0;    ///< [s]
  double wait_max = 0.0;    ///< [s]
};

/// Keeps how long everybody on foot stands, the same way under every controller.
class PeopleLog {
 public:
  /// After each step.
  void observe(const Snapshot& now);
  [[nodiscard]] PeopleFigures figures() const;

 private:
  static constexpr double kStands = 0.1;  ///< [m/s]: SUMO's threshold of waiting

  std::map<std::string, double> waits_;  ///< [s] by person
  double last_ = -1.0;                   ///< [s] time of the last step; < 0: none yet
};

}  // namespace mvtp
