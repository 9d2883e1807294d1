#include "coordinator/controllers/controller_kind.hpp"

namespace mvtp {

/// All vehicles of a control zone are planned together, and the order of passage is searched.
ControllerKind escot_controller() {
  return {.name = kUsualController,
          .meaning = "ESCoT: all vehicles planned together, the order of passage searched",
          .make = [](const ControllerSetup& setup) -> std::unique_ptr<Controller> {
            return std::make_unique<Coordinator>(setup.traffic, setup.area, setup.options);
          },
          .drives = true,
          .on_lots = LotController::kEscot};
}

}  // namespace mvtp
