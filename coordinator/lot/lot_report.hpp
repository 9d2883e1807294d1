#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coordinator/lot/lot_coordinator.hpp"

namespace mvtp {

/// A parking event with what only the trip's record knows. A row of visits.csv.
struct ParkingRecord {
  ParkingEvent event;
  /// [s] when it would have been at the gate with nobody before it; none: it was there at the start
  std::optional<double> at_gate;
};

/// What a run leaves behind of its parking lot.
struct LotReport {
  std::string lot;  ///< id
  int slots = 0;
  std::vector<ParkingRecord> events;
  std::vector<Occupied> occupancy;  ///< the rows of occupancy.csv
};

/// From the gate to the slot, or from when it wants to leave to the exit lane [s]; of a vehicle
/// that is still waiting or under way, up to `end`; none if it made no such trip.
[[nodiscard]] std::optional<double> time_in(const ParkingRecord& record, double end);
[[nodiscard]] std::optional<double> time_out(const ParkingRecord& record, double end);

/// The part "parking" of summary.json: the keys of docs/outputs.md, over all lots.
/// @pre !lots.empty()
[[nodiscard]] nlohmann::ordered_json lots_json(std::span<const LotReport> lots, double end);
[[nodiscard]] std::string parking_events_csv(std::span<const LotReport> lots, double end);
[[nodiscard]] std::string occupancy_csv(std::span<const LotReport> lots);

}  // namespace mvtp
