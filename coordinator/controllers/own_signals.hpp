#pragma once

#include <memory>
#include <string>
#include <vector>

#include "coordinator/controllers/controller_kind.hpp"

namespace mvtp {

/// The signals at the junctions of the setup, ordered by id.
[[nodiscard]] std::vector<std::string> signals_of(const ControllerSetup& setup);

/// The same for a controller that has nothing to do without any.
/// @throws InputError if there are none
[[nodiscard]] std::vector<std::string> signals_needed(const ControllerSetup& setup,
                                                      const std::string& controller);

/// Has the traffic run the phases of these signals itself, and leaves all vehicles to their own
/// drivers.
[[nodiscard]] std::unique_ptr<Controller> run_own_signals(Traffic& traffic,
                                                          const std::vector<std::string>& signals,
                                                          SignalControl control);

}  // namespace mvtp
