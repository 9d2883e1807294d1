#include "coordinator/controllers/controller_kind.hpp"

namespace mvtp {

/// Each vehicle plans once, around all who came before it.
ControllerKind prioritized_controller() {
  return {.name = "prioritized",
          .meaning = "each vehicle plans once, around all earlier ones; no order is searched",
          .make = [](const ControllerSetup& setup) -> std::unique_ptr<Controller> {
            CoordinatorOptions options = setup.options;
            options.escot.crossing.tries = 0;
            return std::make_unique<Coordinator>(setup.traffic, setup.area, options);
          },
          .drives = true,
          .on_lots = LotController::kPrioritized};
}

}  // namespace mvtp
