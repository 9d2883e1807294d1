#pragma once

#include <memory>
#include <set>
#include <string>

#include "coordinator/drivers/braking_analysis.hpp"
#include "coordinator/drivers/human_faults.hpp"
#include "coordinator/report/report.hpp"
#include "coordinator/simulation/simulation.hpp"
#include "tools/coordinate/options.hpp"
#include "traci_bridge/sumo_traffic.hpp"

namespace mvtp {

/// Human drivers who misbehave in a run (`--human-faults`), and what came of it.
class Misbehaviour {
 public:
  /// @param junctions  before these they misbehave.
  Misbehaviour(const CoordinateOptions& options, SumoTraffic& traffic,
               const std::set<std::string>& junctions);

  /// Lets them misbehave; to be added behind those who control others.
  void join(Simulation& simulation) { simulation.add(faults_); }
  /// After each step, when the audit has looked at it.
  void observe(const Snapshot& now, const Audit& audit);
  [[nodiscard]] HumanFaultFigures figures() const;

 private:
  double rate_;
  HumanFaults faults_;
  BrakingAnalysis braking_;
};

/// @return none if nobody is to misbehave
[[nodiscard]] std::unique_ptr<Misbehaviour> make_misbehaviour(
    const CoordinateOptions& options, SumoTraffic& traffic, const std::set<std::string>& junctions);

}  // namespace mvtp
