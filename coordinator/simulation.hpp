#pragma once

#include <vector>

#include "coordinator/controller.hpp"
#include "coordinator/traffic.hpp"

namespace mvtp {

/// The closed loop. Owns the clock: nobody else steps the traffic.
class Simulation {
 public:
  explicit Simulation(Traffic& traffic) : traffic_(traffic) {}

  void add(Controller& controller) { controllers_.push_back(&controller); }

  /// Every controller decides, then every controller acts, then the traffic steps and every
  /// controller looks at what became of it.
  void step();

 private:
  Traffic& traffic_;
  std::vector<Controller*> controllers_;
};

}  // namespace mvtp
