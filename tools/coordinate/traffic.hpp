#pragma once

#include <memory>

#include "coordinator/faults/faulty_traffic.hpp"
#include "tools/coordinate/options.hpp"
#include "tools/coordinate/scenario.hpp"

namespace mvtp {

/// SUMO at the begin of the scenario, every limit set.
/// @throws InputError if its step is too long to drive vehicles by
[[nodiscard]] std::unique_ptr<SumoTraffic> open_traffic(const CoordinateOptions& options,
                                                        const Scenario& scenario);

/// The traffic through the air; nullptr if nothing is to go wrong there.
[[nodiscard]] std::unique_ptr<FaultyTraffic> make_faulty(const CoordinateOptions& options,
                                                         Traffic& traffic);

}  // namespace mvtp
