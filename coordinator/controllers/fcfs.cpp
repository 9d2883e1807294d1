#include "coordinator/controllers/reserving.hpp"

namespace mvtp {

/// A vehicle, and those who follow it from its lane, have the whole junction to themselves.
ControllerKind fcfs_controller() {
  return {.name = "fcfs",
          .meaning = "reservation of the whole junction, first come, first served",
          .make =
              [](const ControllerSetup& setup) {
                return make_reserving(setup, Reservation::kJunction);
              },
          .drives = true};
}

}  // namespace mvtp
