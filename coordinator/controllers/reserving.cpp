#include "coordinator/controllers/reserving.hpp"

namespace mvtp {

std::unique_ptr<Controller> make_reserving(const ControllerSetup& setup, Reservation reservation) {
  CoordinatorOptions options = setup.options;
  options.escot.crossing.tries = 0;
  options.limits.reservation = reservation;
  return std::make_unique<Coordinator>(setup.traffic, setup.area, options);
}

}  // namespace mvtp
