#include "coordinator/controllers/own_signals.hpp"

namespace mvtp {

/// The phases that the network has, each for its own time.
ControllerKind fixed_time_controller() {
  return {.name = "static",
          .meaning = "the network's signal programs with fixed times",
          .make =
              [](const ControllerSetup& setup) {
                return run_own_signals(setup.traffic, signals_needed(setup, "static"),
                                       SignalControl::kFixed);
              },
          .needs_signals = true};
}

}  // namespace mvtp
