#pragma once

#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/network/road_network.hpp"

namespace mvtp {

/// How long vehicles need for their routes without any other vehicle. Speed changes take no time.
class FreeFlow {
 public:
  explicit FreeFlow(const RoadNetwork& network);

  /// Each lane at the vehicle's own multiple of the speed limit, but no faster than it can drive
  /// [s].
  /// @param route        edges in driving order, not empty, all in the network.
  /// @param first_lane   where it departs; the other lanes are those of the first fitting
  ///                     connection.
  /// @param from, to     position of the front bumper on the first and on the last lane [m].
  /// @param max_speed    of the vehicle [m/s].
  [[nodiscard]] double duration(std::span<const std::string> route, const std::string& first_lane,
                                double from, double to, double speed_factor,
                                double max_speed) const;

 private:
  [[nodiscard]] const Connection* connection(const std::string& lane, const std::string& from_edge,
                                             const std::string& to_edge) const;

  const RoadNetwork& network_;
  /// Those from one edge to another, in the order of the network.
  std::map<std::pair<std::string, std::string>, std::vector<const Connection*>> connections_;
};

}  // namespace mvtp
