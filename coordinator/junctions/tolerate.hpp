#pragma once

#include "coordinator/faults/fault_model.hpp"
#include "coordinator/junctions/coordinator.hpp"

namespace mvtp {

/// Makes a coordinator bear what is declared: plans that take effect later, larger safety
/// distances, and a takeover as much earlier as the fastest vehicle drives until a plan for it
/// takes effect.
void tolerate(const FaultTolerance& tolerance, const RoadNetwork& network, double step_length,
              CoordinatorOptions& options);

}  // namespace mvtp
