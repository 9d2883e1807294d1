#pragma once

namespace mvtp {

/// The time of a run of SUMO [s].
struct SumoClock {
  double now = -1.0;  ///< before the start
  double step_length = 0.0;
};

}  // namespace mvtp
