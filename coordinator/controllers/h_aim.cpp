#include "coordinator/controllers/reserving.hpp"

namespace mvtp {

/// A signal for human drivers; automated vehicles reserve tiles whatever it shows, but none on the
/// paths of lanes with green on which a human driver is seen. [Sharon, Stone, A Protocol for Mixed
/// Autonomous and Human-Operated Vehicles at Intersections, 2017]
ControllerKind h_aim_controller() {
  return {
      .name = "h-aim",
      .meaning = "tiles as in aim, off the ground of green lanes where humans are seen (H-AIM)",
      .make =
          [](const ControllerSetup& setup) { return make_reserving(setup, GreenGround::kSensed); },
      .drives = true};
}

}  // namespace mvtp
