#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coordinator/audit/audit.hpp"
#include "coordinator/drivers/braking_analysis.hpp"
#include "coordinator/junctions/coordinator.hpp"
#include "coordinator/lot/lot_report.hpp"
#include "coordinator/measures/driving_style.hpp"
#include "coordinator/measures/emissions.hpp"
#include "coordinator/measures/surrogate_safety.hpp"
#include "coordinator/report/people_log.hpp"

namespace mvtp {

/// One vehicle's trip, all times in seconds. A row of vehicles.csv.
struct VehicleRecord {
  std::string id;
  std::string type;
  double intended_departure = 0.0;
  std::optional<double> departure;  ///< none: never entered the network
  std::optional<double> arrival;    ///< none: unfinished
  double free_flow = 0.0;           ///< duration of its route without any other vehicle
  double time_loss = 0.0;           ///< as SUMO says
  double waiting_time = 0.0;        ///< as SUMO says
  double speed_factor = 1.0;
  double stopped = 0.0;      ///< at scheduled stops
  bool coordinated = false;  ///< was it ever under control
  Priority::Kind priority = Priority::Kind::kNone;
  std::string vehicle_class = {};  ///< SUMO's vClass
  std::string movement = {};       ///< "FROM>TO", the first and the last edge of its route
  DrivingFigures driving = {};
  std::optional<Emissions> emissions = {};  ///< none: the traffic does not tell
  std::optional<double> min_clearance;      ///< [m] to any other vehicle; none: never within 3 m
};

/// Arrival - intended departure - free-flow duration - time at scheduled stops; up to `end` for a
/// vehicle that is not there yet.
[[nodiscard]] double delay_of(const VehicleRecord& vehicle, double end);

/// What came of human-driven vehicles at signals that are ours.
struct HumanFigures {
  std::int64_t greens = 0;              ///< shown
  std::int64_t tube_misses = 0;         ///< drivers outside what was expected, over the decisions
  std::int64_t unplanned_passages = 0;  ///< drivers who went over their lines without a plan
};

/// What was made to go wrong in a run, and what was noticed of it.
struct FaultReport {
  std::string simulated;  ///< in the words of the command line; empty: nothing
  std::string assumed;    ///< likewise
  FaultTolerance tolerance;
  double step_length = 0.1;  ///< [s]
  FaultFigures figures;
  std::vector<FaultEvent> given_up;  ///< vehicles that did not obey
};

/// What came of human drivers who misbehaved.
struct HumanFaultFigures {
  double rate = 0.0;  ///< as asked for
  std::vector<HumanFault> faults;
  std::vector<HumanOverlap> overlaps;  ///< of vehicles under control with human drivers
};

/// Everything that a run leaves behind.
struct RunReport {
  std::vector<VehicleRecord> vehicles;
  AuditFigures audit;
  std::vector<Replan> replans;
  std::vector<AuditEvent> events;
  std::vector<LotReport> lots;
  ConflictFigures pet;  ///< post-encroachment times
  ConflictFigures ttc;  ///< times to collision
  std::int64_t sumo_collisions = 0;
  double penetration = 1.0;                       ///< as asked for
  std::optional<HumanFigures> humans;             ///< none: no signal was ours
  std::optional<FaultReport> faults;              ///< none: nothing was simulated nor assumed
  std::optional<HumanFaultFigures> human_faults;  ///< none: nobody was asked to misbehave
  PeopleFigures people;
  std::int64_t people_greens = 0;           ///< shown at crossings
  int detours = 0;                          ///< drivers who left their routes, see WrongLanes
  int lane_swaps = 0;                       ///< pairs of drivers, see WrongLanes
  std::int64_t left_to_sumo_sightings = 0;  ///< vehicles near a stop line, over the decisions
  double begin = 0.0;                       ///< [s] simulated time
  double end = 0.0;                         ///< [s]
  double wall_time = 0.0;                   ///< [s] of the simulation loop
  std::string controller;
  std::string status;   ///< as of to_string(RunStatus)
  std::string message;  ///< what went wrong, in one line; empty if nothing did
  std::vector<ZoneFigures> zones;
  std::vector<LeftToTraffic> left_to_sumo;
  std::int64_t sumo_warnings = 0;
  std::string sumo_version;
  std::string mvtp_version;
  std::uint64_t seed = 0;
  std::string command;
};

/// Did every vehicle, of at least one, arrive, and did no CAV touch another?
[[nodiscard]] bool succeeded(const RunReport& report);

/// The figures that a run is judged by first.
struct Headline {
  double mean_delay = 0.0;  ///< [s]
  double p95_delay = 0.0;   ///< [s]
  double throughput = 0.0;  ///< [veh/h]
  std::int64_t completed = 0;
  double replan_p95 = 0.0;  ///< [ms]
};
[[nodiscard]] Headline headline(const RunReport& report);

/// The text of summary.json: the keys of docs/outputs.md.
[[nodiscard]] std::string summary_json(const RunReport& report);
[[nodiscard]] std::string vehicles_csv(const RunReport& report);
[[nodiscard]] std::string replans_csv(const RunReport& report);
[[nodiscard]] std::string events_csv(const RunReport& report);

}  // namespace mvtp
