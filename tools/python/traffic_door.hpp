#pragma once

#include "planner/problem/input_error.hpp"
#include "traci_bridge/sumo_traffic.hpp"

namespace mvtp {

/// The traffic as Python holds it: longer, perhaps, than there is one.
class TrafficDoor {
 public:
  explicit TrafficDoor(SumoTraffic& traffic) : traffic_(&traffic) {}

  /// @throws InputError once it is closed
  [[nodiscard]] SumoTraffic& open() const {
    if (traffic_ == nullptr) {
      throw InputError("simulation", "has ended; make a new mvtp.Simulation");
    }
    return *traffic_;
  }
  void close() { traffic_ = nullptr; }

 private:
  SumoTraffic* traffic_;
};

}  // namespace mvtp
