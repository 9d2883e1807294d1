#pragma once

#include <algorithm>
#include <string>

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

  // For what is said to one of them. @throws InputError if there is none with this id, which SUMO
  // would call a broken scenario
  [[nodiscard]] SumoTraffic& with_vehicle(const std::string& id) const {
    if (is_on_road(id)) return *traffic_;
    throw InputError("vehicle " + id, "is not on the road; see vehicles().ids");
  }
  [[nodiscard]] SumoTraffic& with_taken_over(const std::string& id) const {
    if (with_vehicle(id).is_taken_over(id)) return *traffic_;
    throw InputError("vehicle " + id, "is not taken over; take_over() it first");
  }
  [[nodiscard]] SumoTraffic& with_vehicle_or_pending(const std::string& id) const {
    if (is_on_road(id) || std::ranges::count(traffic_->pending(), id) > 0) return *traffic_;
    throw InputError("vehicle " + id, "is not on the road; see vehicles().ids and pending()");
  }
  [[nodiscard]] SumoTraffic& with_signal(const std::string& id) const {
    if (open().network().signals.contains(id)) return *traffic_;
    throw InputError("signal " + id, "is not in the network; see network.signals");
  }
  [[nodiscard]] SumoTraffic& with_lane(const std::string& id) const {
    if (open().network().lanes.contains(id)) return *traffic_;
    throw InputError("lane " + id, "is not in the network; see network.lanes");
  }
  [[nodiscard]] SumoTraffic& with_type(const std::string& id) const {
    if (std::ranges::count(open().types(), id) > 0 ||
        std::ranges::count(traffic_->vehicles(), id, &VehicleState::type) > 0) {
      return *traffic_;
    }
    throw InputError("type " + id, "is not in the scenario; see types()");
  }

 private:
  [[nodiscard]] bool is_on_road(const std::string& id) const {
    return std::ranges::count(open().vehicles(), id, &VehicleState::id) > 0;
  }

  SumoTraffic* traffic_;
};

}  // namespace mvtp
