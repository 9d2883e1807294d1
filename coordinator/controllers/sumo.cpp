#include "coordinator/controllers/controller_kind.hpp"

namespace mvtp {

/// The scenario as it comes, signals and all.
ControllerKind sumo_controller() {
  return {.name = kSumosController,
          .meaning = "SUMO's own control, as the scenario comes",
          .make = [](const ControllerSetup& /*setup*/) -> std::unique_ptr<Controller> {
            return std::make_unique<HumanDriversOnly>();
          }};
}

}  // namespace mvtp
