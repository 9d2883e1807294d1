#include <set>

#include "coordinator/controllers/own_signals.hpp"
#include "coordinator/controllers/phase_selection.hpp"

namespace mvtp {
namespace {

constexpr double kWaveReach = 50.0;  ///< [m], as in its authors' code

/// Vehicles on the lanes that have green. [Ault, Sharon, Reinforcement Learning Benchmarks for
/// Traffic Signal Control, 2021: MaxWave]
double wave(const std::vector<const SignalLink*>& green, const LaneCounts& counts) {
  std::set<std::string> lanes;
  for (const SignalLink* link : green) lanes.insert(link->from_lane);
  double sum = 0.0;
  for (const std::string& lane : lanes) sum += counts.on_lane(lane);
  return sum;
}

}  // namespace

/// The phase for the longest wave of vehicles.
ControllerKind max_wave_controller() {
  return {.name = "max-wave",
          .meaning = "of the network's phases the one with most vehicles before it",
          .make = [](const ControllerSetup& setup) -> std::unique_ptr<Controller> {
            return std::make_unique<PhaseSelection>(
                setup.traffic, signals_needed(setup, "max-wave"), kWaveReach, wave);
          },
          .needs_signals = true};
}

}  // namespace mvtp
