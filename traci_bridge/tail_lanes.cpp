#include "traci_bridge/tail_lanes.hpp"

#include <algorithm>

namespace mvtp {

double where_tail_is_found(double position, double length, double step, double lane_length,
                           std::span<const double> before) {
  constexpr double kSpare = 1e-3;  // [m]
  const double tail_then = length - std::min(position + step, lane_length);
  double covered = 0.0;  // [m] behind the begin of the lane, by those on which it is then
  auto next = before.begin();
  while (next != before.end() && covered < tail_then) covered += *next++;
  if (next == before.end()) return position;
  const double most = covered + *next - kSpare;  // [m] of tail before the step, on one lane more
  return std::clamp(length - most, position, std::max(position, lane_length));
}

}  // namespace mvtp
