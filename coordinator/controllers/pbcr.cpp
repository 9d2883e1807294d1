#include "coordinator/controllers/controller_kind.hpp"

namespace mvtp {

/// ESCoT without groups: what is left of it [ESCoT, Alg. 1].
ControllerKind pbcr_controller() {
  return {.name = "pbcr",
          .meaning = "PBCR alone: every step by priorities, nobody plans ahead",
          .make = [](const ControllerSetup& setup) -> std::unique_ptr<Controller> {
            CoordinatorOptions options = setup.options;
            options.escot.plans_groups = false;
            return std::make_unique<Coordinator>(setup.traffic, setup.area, options);
          },
          .drives = true,
          .on_lots = LotController::kPbcr};
}

}  // namespace mvtp
