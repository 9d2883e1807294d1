#include "coordinator/controllers/own_signals.hpp"

namespace mvtp {

/// The same phases, each until nobody comes any more.
ControllerKind actuated_controller() {
  return {.name = "actuated",
          .meaning = "the same phases, ended by SUMO's detectors (gap-based actuation)",
          .make =
              [](const ControllerSetup& setup) {
                return run_own_signals(setup.traffic, signals_needed(setup, "actuated"),
                                       SignalControl::kActuated);
              },
          .needs_signals = true};
}

}  // namespace mvtp
