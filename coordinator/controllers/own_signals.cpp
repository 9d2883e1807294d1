#include "coordinator/controllers/own_signals.hpp"

#include <set>

#include "planner/problem/input_error.hpp"

namespace mvtp {

std::vector<std::string> signals_of(const ControllerSetup& setup) {
  const RoadNetwork& network = setup.traffic.network();
  std::set<std::string> signals;
  for (const std::string& id : setup.options.junctions) {
    for (const Connection& connection : network.junctions.at(id).connections) {
      if (!connection.signal.empty()) signals.insert(connection.signal);
    }
  }
  return {signals.begin(), signals.end()};
}

std::vector<std::string> signals_needed(const ControllerSetup& setup,
                                        const std::string& controller) {
  std::vector<std::string> signals = signals_of(setup);
  if (signals.empty()) {
    throw InputError("--controller " + controller,
                     "runs traffic signals, and there is none at these junctions; take a network "
                     "with signals, or another controller");
  }
  return signals;
}

std::unique_ptr<Controller> run_own_signals(Traffic& traffic,
                                            const std::vector<std::string>& signals,
                                            SignalControl control) {
  for (const std::string& signal : signals) traffic.control_signal(signal, control);
  return std::make_unique<HumanDriversOnly>();
}

}  // namespace mvtp
