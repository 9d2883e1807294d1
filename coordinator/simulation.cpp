#include "coordinator/simulation.hpp"

namespace mvtp {

void Simulation::step() {
  for (Controller* controller : controllers_) controller->decide();
  for (Controller* controller : controllers_) controller->act();
  traffic_.step();
  for (Controller* controller : controllers_) controller->observe();
}

}  // namespace mvtp
