#include "coordinator/controllers/reserving.hpp"

namespace mvtp {

/// Each tile of the junction is reserved for whoever is on it. [Dresner, Stone, A Multiagent
/// Approach to Autonomous Intersection Management, 2008]
ControllerKind aim_controller() {
  return {
      .name = "aim",
      .meaning = "reservation of tiles, first come, first served (Dresner & Stone)",
      .make =
          [](const ControllerSetup& setup) { return make_reserving(setup, Reservation::kTiles); },
      .drives = true};
}

}  // namespace mvtp
