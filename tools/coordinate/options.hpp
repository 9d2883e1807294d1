#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/controllers/registry.hpp"

namespace CLI {
class App;
}

namespace mvtp {

/// The command line of `mvtp coordinate`.
struct CoordinateOptions {
  std::string configuration;                  ///< *.sumocfg
  std::vector<std::string> junctions;         ///< none: all with conflicting connections
  double zone_radius = 80.0;                  ///< [m]
  double penetration = 1.0;                   ///< share of vehicles that are taken over
  std::vector<std::string> coordinate_types;  ///< ids; none: all
  std::vector<std::string> human_types;       ///< ids
  std::string signal_timing = "real";         ///< or "instant"
  std::string intent = "known";               ///< or "lane", "none"
  double human_faults = 0.0;                  ///< share of human drivers who misbehave
  std::string controller = kUsualController;  ///< one of controller_kinds()
  std::string parking = "any";                ///< or "forward", "reverse"
  std::vector<std::string> breakdowns;        ///< VEHICLE@SECONDS
  std::string output_dir = "out";
  std::string remote;   ///< HOST:PORT of a SUMO to be joined; empty: start one
  int order = 1;        ///< of this client of it
  int num_clients = 1;  ///< that it waits for
  bool gui = false;
  bool separate_process = false;  ///< SUMO is a program of its own: no option of the command
  bool quiet = false;
  std::uint32_t seed = 23423;               ///< SUMO's own default
  std::optional<double> end;                ///< [s]
  double max_lateral_accel = 0.0;           ///< [m/s^2]; 0: no limit but the lanes'
  double replan_budget_ms = -1.0;           ///< [ms]; < 0: the decision period
  double replan_budget_from = 0.0;          ///< [s]
  std::string faults;                       ///< KEY=VALUE,...; empty: none
  std::string assume_noise;                 ///< KEY=VALUE,... or "faults"; empty: none
  std::vector<std::string> priority_types;  ///< ids
  int tries = 30;
  int threads = 0;             ///< that plan; 0: one per core
  double margin_along = 0.6;   ///< [m]
  double margin_across = 0.4;  ///< [m]
  bool no_view = false;
  bool no_fcd = false;
  std::string dump_instances;     ///< folder; empty: none
  int dump_every = 20;            ///< decisions with at least two vehicles
  std::vector<std::string> sumo;  ///< more options for SUMO, behind "--"
};

/// @throws InputError, which names all that there are, for a name of none
[[nodiscard]] const ControllerKind& controller_named(const std::string& option,
                                                     const std::string& name);

/// Declares the options that say what is run and how it is coordinated: all but the controller, the
/// seed and the output. `mvtp compare` hands them on to each of its runs.
void declare_run_options(CLI::App& app, CoordinateOptions& options);
/// Declares all options of `mvtp coordinate`.
void declare_coordinate_options(CLI::App& app, CoordinateOptions& options);

}  // namespace mvtp
