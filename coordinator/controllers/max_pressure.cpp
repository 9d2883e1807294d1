#include "coordinator/controllers/own_signals.hpp"
#include "coordinator/controllers/phase_selection.hpp"

namespace mvtp {
namespace {

constexpr double kPressureReach = 200.0;  ///< [m] [Ault, Sharon 2021]

/// The sum of its movements' pressures: those who want to go there, less those who are there
/// already and want to go on, shared out evenly among the paths on. A road that leaves the network
/// takes all. [Varaiya, Max pressure control of a network of signalized intersections, 2013]
double pressure(const std::vector<const SignalLink*>& green, const LaneCounts& counts) {
  double sum = 0.0;
  for (const SignalLink* link : green) {
    sum += counts.heading(link->from_lane, link->to_edge);
    if (link->movements_on > 0) sum -= double(counts.on_edge(link->to_edge)) / link->movements_on;
  }
  return sum;
}

}  // namespace

/// The phase with the largest pressure.
ControllerKind max_pressure_controller() {
  return {.name = "max-pressure",
          .meaning = "of the network's phases the one with the largest pressure (Varaiya)",
          .make = [](const ControllerSetup& setup) -> std::unique_ptr<Controller> {
            return std::make_unique<PhaseSelection>(
                setup.traffic, signals_needed(setup, "max-pressure"), kPressureReach, pressure);
          },
          .needs_signals = true};
}

}  // namespace mvtp
