#pragma once

#include <map>
#include <set>
#include <span>
#include <string>

#include "coordinator/audit/audit.hpp"
#include "coordinator/junctions/coordinator.hpp"
#include "coordinator/report/report.hpp"
#include "coordinator/simulation/simulation.hpp"
#include "tools/coordinate/options.hpp"
#include "tools/coordinate/tube_recorder.hpp"
#include "tools/view/replay.hpp"

namespace mvtp {

/// Records a SUMO run for its replay page.
class RunRecorder {
 public:
  /// @param coordinator  who drives at the junctions; nullptr: nobody but SUMO. Like the traffic,
  /// it
  ///   outlives the recorder.
  RunRecorder(const CoordinateOptions& options, const Traffic& traffic,
              const std::set<std::string>& junctions, std::span<const ParkingLot> lots,
              const Coordinator* coordinator, const RunReport& report);

  void observe(const Snapshot& now, const Audit& audit);

  /// The page, with the figures of the finished report as its header.
  [[nodiscard]] std::string page(const RunReport& report);

 private:
  /// Who is planned together with whom.
  struct Member {
    std::size_t group = 0;  ///< index of its first vehicle
    int rank = 0;           ///< in the order in which they were planned, 1 first
  };

  /// As it is drawn.
  struct DrawnCorridor {
    Pose line;                 ///< where its first stop line is
    std::vector<Point> shape;  ///< [m]
  };

  std::size_t index_of(const Observation& observation);
  std::size_t index_of(const Pedestrian& person);
  [[nodiscard]] std::map<std::string, Member> members() const;
  void observe_events(const Audit& audit);
  void observe_corridors();

  const CoordinateOptions& options_;
  const Traffic& traffic_;
  const Coordinator* coordinator_;
  ReplayRecorder recorder_;
  TubeRecorder tubes_;
  ControlledShare share_;
  bool drives_;  ///< does the controller take vehicles over?
  std::map<std::string, std::size_t> indices_;
  std::map<std::string, std::size_t> people_;
  std::map<std::string, std::optional<double>> co2_;  ///< [g/s] as of the last frame that is kept
  std::size_t events_seen_ = 0;
  std::set<int> seen_corridors_;                                         ///< numbers
  std::map<std::vector<std::pair<int, int>>, DrawnCorridor> corridors_;  ///< by lanes and targets
};

}  // namespace mvtp
