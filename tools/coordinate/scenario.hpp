#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/cli/run_folder.hpp"
#include "tools/coordinate/options.hpp"
#include "traci_bridge/configuration.hpp"
#include "traci_bridge/sumo_traffic.hpp"

namespace mvtp {

/// What the route and additional files of a scenario hold, found without reading them in full.
struct Demand {
  std::optional<double> last_departure;  ///< [s]
  bool people = false;
  bool rerouters = false;
  bool rerouting_devices = false;  ///< vehicles or types ask for one
  bool rerouting_periods = false;  ///< and say themselves how often it looks for a new route
};

/// A SUMO scenario about to be run.
struct Scenario {
  SumoConfiguration configuration;
  SumoOptions sumo;
  std::optional<double> end;  ///< [s] simulated; none: until the last vehicle has arrived
  Demand demand;
  /// What the user should know before the run: what is not done as the scenario says, and what of
  /// it is not coordinated.
  std::vector<std::string> notes;
};

/// SUMO's step is no longer than this [s]; scenarios with a longer one run at kStepLength.
constexpr double kLongestStep = 0.25;
constexpr double kStepLength = 0.1;

/// Reads the scenario and decides how SUMO is run on it, its outputs going to the folder.
/// @param point  called while files are read, and while SUMO is opened
/// @throws InputError
[[nodiscard]] Scenario plan_run(const CoordinateOptions& options, RunFolder& folder,
                                const InterruptionPoint& point = never_interrupted);

/// More notes, about what the network and the vehicle types hold.
[[nodiscard]] std::vector<std::string> notes_on(const Traffic& traffic);

/// Writes copies of our outputs where the scenario asks for the same ones, since SUMO writes each
/// only once. Returns a note for each that could not be written.
[[nodiscard]] std::vector<std::string> copy_outputs(const Scenario& scenario,
                                                    const std::string& configuration);

}  // namespace mvtp
