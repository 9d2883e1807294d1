#include "coordinator/corridor/lateral_limits.hpp"

#include <algorithm>
#include <cmath>

#include "coordinator/network/polyline.hpp"

namespace mvtp {
std::map<std::string, double> bend_speed_limits(const RoadNetwork& network,
                                                double max_lateral_accel) {
  constexpr double kStraight = 0.35;  // [rad]: a lane that turns less is only shifted sideways
  std::map<std::string, double> limits;
  for (const auto& [id, junction] : network.junctions) {
    for (const Connection& c : junction.connections) {
      if (c.via.empty()) continue;
      const auto& before = network.lanes.at(c.from_lane).shape;
      const auto& behind = network.lanes.at(c.to_lane).shape;
      const double turn = std::abs(wrap_to_pi(heading(behind[0], behind[1]) -
                                              heading(before[before.size() - 2], before.back())));
      if (turn < kStraight) continue;
      double length = 0.0;
      for (const std::string& via : c.via) length += network.lanes.at(via).length;
      const double speed = std::sqrt(max_lateral_accel * length / turn);
      for (const std::string& via : c.via) {
        if (speed < network.lanes.at(via).speed_limit) limits[via] = speed;
      }
    }
  }
  return limits;
}

}  // namespace mvtp
