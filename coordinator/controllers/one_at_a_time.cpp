#include "coordinator/controllers/controller_kind.hpp"

namespace mvtp {

/// On parking lots one vehicle drives while all others wait.
ControllerKind one_at_a_time_controller() {
  return {.name = "one-at-a-time",
          .meaning = "on parking lots: one vehicle drives, the others wait",
          .drives = true,
          .on_lots = LotController::kOneAtATime};
}

}  // namespace mvtp
