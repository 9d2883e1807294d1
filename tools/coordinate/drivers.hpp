#pragma once

#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "coordinator/junctions/coordinator.hpp"
#include "coordinator/junctions/instance_dump.hpp"
#include "coordinator/lot/lot_coordinator.hpp"
#include "coordinator/network/drivable_area.hpp"
#include "coordinator/report/report.hpp"
#include "coordinator/report/trip_log.hpp"
#include "coordinator/simulation/simulation.hpp"
#include "planner/problem/interruption.hpp"
#include "tools/cli/run_folder.hpp"
#include "tools/coordinate/lot_recorder.hpp"
#include "tools/coordinate/options.hpp"

namespace mvtp {

/// The junctions that are coordinated: those that the options name, else all with conflicting
/// connections but those that belong to parking lots alone.
/// @throws InputError if one is not in the network, or if there are none and no lots either.
[[nodiscard]] std::set<std::string> coordinated_junctions(const CoordinateOptions& options,
                                                          const RoadNetwork& network,
                                                          std::span<const ParkingLot> lots);

/// What the plans have to bear, by `--assume-noise`.
/// @throws InputError
[[nodiscard]] FaultTolerance declared_tolerance(const CoordinateOptions& options,
                                                const Traffic& traffic);
/// Which vehicles are taken over.
[[nodiscard]] ControlledShare controlled_share(const CoordinateOptions& options);
/// Options that have no effect on human drivers or faults, as there are none, and what would give
/// them some; empty if there are no such options.
[[nodiscard]] std::string note_without_effect(const CoordinateOptions& options);
/// Which of the coordinated junctions have no light to tell human drivers that they may go, and
/// what comes of it; empty if all have one or if there are no human drivers.
[[nodiscard]] std::string note_on_missing_lights(const CoordinateOptions& options,
                                                 const RoadNetwork& network,
                                                 const std::set<std::string>& junctions);

/// Who drives in a run, side by side: a controller for each parking lot and one for the junctions;
/// or nobody but SUMO.
class Drivers {
 public:
  /// @param point  called before each of them @throws InputError
  Drivers(const CoordinateOptions& options, Traffic& traffic, const DrivableArea& area,
          const std::set<std::string>& junctions, std::span<const ParkingLot> lots,
          const InterruptionPoint& point);

  /// One more, from outside; it outlives the drivers.
  void plug_in(Controller& controller) { guests_.push_back(&controller); }
  /// Lets them take part; so do those who watch the lots, and who dumps decisions.
  void join(Simulation& simulation);
  /// A line for each control zone: its junctions, and how many movements lead over them.
  [[nodiscard]] std::vector<std::string> describe_zones() const;
  /// Who drives at the junctions; nullptr: nobody but SUMO.
  [[nodiscard]] const Coordinator* coordinator() const { return coordinator_; }
  /// What they did.
  void report_to(RunReport& report) const;
  /// How it went on the parking lots.
  void report_lots(RunReport& report, const TripLog& log, std::span<const Trip> trips,
                   const FreeFlow& free_flow, Simulation& simulation) const;
  /// The files about the parking lots, if there are any.
  void write_lot_files(const RunReport& report, RunFolder& folder) const;

 private:
  /// Everyone who takes part, guests last.
  [[nodiscard]] std::vector<Controller*> all() const;

  std::vector<std::unique_ptr<Controller>> controllers_;
  std::vector<Controller*> guests_;
  const Coordinator* coordinator_ = nullptr;  ///< the one of the junctions
  std::vector<std::unique_ptr<LotRecorder>> lots_;
  std::optional<InstanceDump> dump_;
};

}  // namespace mvtp
