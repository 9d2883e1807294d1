#pragma once

#include <optional>
#include <string>

#include "coordinator/measures/emissions.hpp"

namespace mvtp {

/// One vehicle's trip as the traffic records it.
struct Trip {
  std::string id;
  std::string type;
  std::optional<double> depart;  ///< [s]; none if it never entered the network
  double depart_delay = 0.0;     ///< [s] after its intended departure
  std::string depart_lane;
  double depart_position = 0.0;   ///< of the front bumper from the start of the lane [m]
  double depart_speed = 0.0;      ///< [m/s]
  std::optional<double> arrival;  ///< [s]; none if unfinished
  std::string arrival_lane;       ///< where it arrived, or was last
  double arrival_position = 0.0;  ///< [m]
  double duration = 0.0;          ///< [s]
  double route_length = 0.0;      ///< driven [m]; wrong for a vehicle that left its lanes
  double time_loss = 0.0;         ///< [s]; wrong for a vehicle that left its lanes
  double waiting_time = 0.0;      ///< below 0.1 m/s [s]
  double speed_factor = 1.0;
  std::optional<Emissions> emissions = {};
  std::string vaporized;  ///< why it was taken off the road; empty if it was not
};

}  // namespace mvtp
