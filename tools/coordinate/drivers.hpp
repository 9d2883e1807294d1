#pragma once

#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "coordinator/coordinator.hpp"
#include "coordinator/drivable_area.hpp"
#include "coordinator/human_faults.hpp"
#include "coordinator/instance_dump.hpp"
#include "coordinator/lot_coordinator.hpp"
#include "coordinator/report.hpp"
#include "coordinator/simulation.hpp"
#include "coordinator/trip_log.hpp"
#include "tools/coordinate/lot_recorder.hpp"
#include "tools/coordinate/options.hpp"
#include "tools/run_folder.hpp"

namespace mvtp {

/// The junctions that are coordinated: those that the options name, else all with conflicting
/// connections but those that belong to parking lots alone.
/// @throws InputError if one is not in the network, or if there are none and no lots either.
[[nodiscard]] std::set<std::string> coordinated_junctions(const CoordinateOptions& options,
                                                          const RoadNetwork& network,
                                                          std::span<const ParkingLot> lots);

/// Who drives in a run, side by side: a controller for each parking lot and one for the junctions;
/// or nobody but SUMO.
class Drivers {
 public:
  /// @throws InputError
  Drivers(const CoordinateOptions& options, Traffic& traffic, const DrivableArea& area,
          const std::set<std::string>& junctions, std::span<const ParkingLot> lots);

  /// Lets them take part; so do those who watch the lots, and who dumps decisions.
  void join(Simulation& simulation);
  /// Human drivers who misbehave; nullptr: nobody is asked to.
  [[nodiscard]] const HumanFaults* faults() const { return faults_.get(); }
  /// What they did.
  void report_to(RunReport& report) const;
  /// How it went on the parking lots.
  void report_lots(RunReport& report, const TripLog& log, std::span<const Trip> trips,
                   const FreeFlow& free_flow, Simulation& simulation) const;
  /// The files about the parking lots, if there are any.
  void write_lot_files(const RunReport& report, RunFolder& folder) const;

 private:
  std::vector<std::unique_ptr<Controller>> controllers_;
  const Coordinator* coordinator_ = nullptr;  ///< the one of the junctions
  std::unique_ptr<HumanFaults> faults_;
  double fault_rate_ = 0.0;
  std::vector<std::unique_ptr<LotRecorder>> lots_;
  std::optional<InstanceDump> dump_;
};

}  // namespace mvtp
