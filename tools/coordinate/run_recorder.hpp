#pragma once

#include <map>
#include <set>
#include <span>
#include <string>

#include "coordinator/audit.hpp"
#include "coordinator/report.hpp"
#include "tools/coordinate/options.hpp"
#include "tools/view/replay.hpp"

namespace mvtp {

/// Records a SUMO run for its replay page.
class RunRecorder {
 public:
  RunRecorder(const CoordinateOptions& options, const RoadNetwork& network,
              const std::set<std::string>& junctions, std::span<const ParkingLot> lots,
              const RunReport& report);

  void observe(double time, std::span<const Sighting> sightings, const Audit& audit);

  /// The page, with the figures of the finished report as its header.
  [[nodiscard]] std::string page(const RunReport& report);

 private:
  std::size_t index_of(const Sighting& sighting);

  ReplayRecorder recorder_;
  std::map<std::string, std::size_t> indices_;
  std::size_t events_seen_ = 0;
};

}  // namespace mvtp
