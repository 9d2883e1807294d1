#pragma once

#include <optional>
#include <string>
#include <vector>

#include "coordinator/traffic.hpp"
#include "traci_bridge/sumo_api.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {

/// @throws std::runtime_error if its turning radius is no length.
[[nodiscard]] VehicleType read_type(const std::string& id);

/// All persons that do not ride, ordered by id.
[[nodiscard]] std::vector<Pedestrian> read_pedestrians();

/// Pairs that SUMO reports as colliding in this step.
[[nodiscard]] int count_collisions();

struct NextStop {
  int index = 0;  ///< among the next stops
  libsumo::TraCINextStopData data;
};

/// The vehicle's next stop in a parking area.
[[nodiscard]] std::optional<NextStop> next_parking_stop(const std::string& id);
[[nodiscard]] bool is_parked(const std::string& id);
/// Has SUMO put the vehicle onto the lane beside the parking area in which it is to stand?
[[nodiscard]] bool is_placed_beside_its_parking(const std::string& id);
/// Has the lane beside the vehicle's parking area room for it?
[[nodiscard]] bool is_lane_free_beside(const std::string& id);

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
