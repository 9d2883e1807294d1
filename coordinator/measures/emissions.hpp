#pragma once

namespace mvtp {

/// What one vehicle burnt and left behind on its trip.
struct Emissions {
  double fuel = 0.0;  ///< [ml]
  double co2 = 0.0;   ///< [g]
  double nox = 0.0;   ///< [g]
};

}  // namespace mvtp
