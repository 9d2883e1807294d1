#include "coordinator/controllers/reserving.hpp"

namespace mvtp {

/// A signal for human drivers; automated vehicles reserve tiles whatever it shows, but none on the
/// paths of lanes with green. [Dresner, Stone, A Multiagent Approach to Autonomous Intersection
/// Management, 2008, FCFS-Light]
ControllerKind fcfs_light_controller() {
  return {
      .name = "fcfs-light",
      .meaning = "tiles as in aim, off the ground of lanes that have green (FCFS-Light)",
      .make = [](const ControllerSetup& setup) { return make_reserving(setup, GreenGround::kAll); },
      .drives = true};
}

}  // namespace mvtp
