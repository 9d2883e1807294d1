#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "coordinator/audit/audit.hpp"
#include "coordinator/report/free_flow.hpp"
#include "coordinator/report/report.hpp"
#include "coordinator/report/trip.hpp"
#include "coordinator/simulation/simulation.hpp"
#include "planner/problem/parking_lot.hpp"

namespace mvtp {

/// Keeps what becomes of each vehicle: its route, when it came and went, who drove it, and how long
/// it stood at scheduled stops.
class TripLog {
 public:
  explicit TripLog(const Traffic& traffic) : traffic_(traffic) {}

  /// After each step.
  void observe(const Snapshot& now);

  /// The trips as far as they can be told by watching: without time loss and waiting time, and with
  /// departure delays to the second. For when the traffic's own record is not there (yet).
  [[nodiscard]] std::vector<Trip> trips() const;

  /// The records of trips, ordered by id.
  /// @param trips       the traffic's own record, or that of trips().
  /// @param max_speed   of a vehicle type [m/s].
  /// @param clearances  as in Audit.
  [[nodiscard]] std::vector<VehicleRecord> records(
      std::span<const Trip> trips, const FreeFlow& free_flow, double end,
      const std::function<double(const std::string&)>& max_speed,
      const std::map<std::string, double>& clearances) const;

  /// When each vehicle would have been at the gate of a lot if nobody had been before it [s].
  [[nodiscard]] std::map<std::string, double> times_at_gate(
      std::span<const Trip> trips, const FreeFlow& free_flow, double end, const ParkingLot& lot,
      const std::function<VehicleType(const std::string&)>& type) const;

 private:
  struct Entry {
    Trip trip;
    std::vector<std::string> route;
    double top_speed = 0.0;  ///< VehicleState::top_speed [m/s]
    bool coordinated = false;
    double stopped = 0.0;  ///< [s]
    double last_seen = 0.0;
  };

  void begin(const Snapshot& now, const Observation& observation, Entry& entry) const;

  [[nodiscard]] const std::string& first_lane(const std::string& edge) const;

  const Traffic& traffic_;
  std::map<std::string, Entry> entries_;
  std::map<std::string, double> wanted_;  ///< when those that had to wait were first seen [s]
  double last_ = -1e300;                  ///< time of the last one [s]
};

}  // namespace mvtp
