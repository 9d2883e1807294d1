#include "coordinator/controllers/reserving.hpp"

namespace mvtp {

/// Where two paths meet, the whole of it belongs to one of the two vehicles at a time. [the idea of
/// Moveover, arXiv 2603.05165]
ControllerKind conflict_zone_controller() {
  return {.name = "conflict-zone",
          .meaning = "reservation of whole conflict areas, first come, first served",
          .make =
              [](const ControllerSetup& setup) {
                return make_reserving(setup, Reservation::kConflictArea);
              },
          .drives = true};
}

}  // namespace mvtp
