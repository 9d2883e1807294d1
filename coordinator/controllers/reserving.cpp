#include "coordinator/controllers/reserving.hpp"

namespace mvtp {

std::unique_ptr<Controller> make_reserving(const ControllerSetup& setup, Reservation reservation) {
  CoordinatorOptions options = setup.options;
  options.escot.crossing.tries = 0;
  options.limits.reservation = reservation;
  return std::make_unique<Coordinator>(setup.traffic, setup.area, options);
}

std::unique_ptr<Controller> make_reserving(const ControllerSetup& setup, GreenGround greens) {
  ControllerSetup with_greens = setup;
  with_greens.options.greens = greens;
  // Whoever has no plan before red mostly has none in any order.
  with_greens.options.escot.crossing.repairs = 2;
  return make_reserving(with_greens, Reservation::kTiles);
}

}  // namespace mvtp
