#include "coordinator/controllers/own_signals.hpp"

namespace mvtp {

/// Signals, if there are any, are off: right of way holds.
ControllerKind priority_controller() {
  return {.name = "priority",
          .meaning = "right of way: signals are switched off",
          .make = [](const ControllerSetup& setup) {
            return run_own_signals(setup.traffic, signals_of(setup), SignalControl::kOff);
          }};
}

}  // namespace mvtp
