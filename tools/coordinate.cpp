#include <fstream>
#include <memory>

#include "tools/commands.hpp"
#include "tools/coordinate_run.hpp"

namespace mvtp {
namespace {

void declare_options(CLI::App& app, CoordinateOptions& o) {
  const auto finite = CLI::Range(0.0, 1e9);
  app.add_option("-c,--configuration", o.configuration, "SUMO scenario (*.sumocfg)")
      ->required()
      ->group("Input");
  app.add_option("--seed", o.seed, "Seed of SUMO's random numbers and of ours")
      ->capture_default_str()
      ->group("Input");
  app.add_option("--end", o.end, "Simulated time at which to end [s] (default: all have arrived)")
      ->check(finite)
      ->group("Input");

  app.add_option("--controller", o.controller, "escot, or sumo: SUMO's own control, for comparison")
      ->check(CLI::IsMember({"escot", "sumo"}))
      ->capture_default_str()
      ->group("Control");
  app.add_option("--junction", o.junctions,
                 "Junction to coordinate; repeatable (default: all with conflicting connections)")
      ->group("Control");
  app.add_option("--zone-radius", o.zone_radius, "Takeover this far before the stop line [m]")
      ->check(CLI::Range(20.0, 1000.0))
      ->capture_default_str()
      ->group("Control");
  app.add_option(
         "--max-lateral-accel", o.max_lateral_accel,
         "Limit in bends for every vehicle, SUMO's too [m/s^2] (0: the lanes' speed limits)")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str()
      ->group("Control");
  app.add_option("--margin-along", o.margin_along, "Safety distance ahead and behind, in all [m]")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str()
      ->group("Control");
  app.add_option("--margin-across", o.margin_across, "Safety distance at the sides, in all [m]")
      ->check(CLI::Range(0.0, 1.3))
      ->capture_default_str()
      ->group("Control");
  app.add_option("--tries", o.tries, "Orders of passage tried per replan (0: order of arrival)")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str()
      ->group("Control");
  app.add_option("--replan-budget-ms", o.replan_budget_ms,
                 "Drop plans that take longer [ms]; 0: no planning, as if the planner were dead "
                 "(default: no limit)")
      ->check(finite)
      ->group("Control");
  app.add_option("--replan-budget-from", o.replan_budget_from,
                 "Simulated time from which the budget holds [s]")
      ->check(finite)
      ->capture_default_str()
      ->group("Control");

  app.add_option("--output-dir", o.output_dir, "Folder of the results; made if missing")
      ->capture_default_str()
      ->group("Output");
  app.add_flag("--no-view", o.no_view, "Do not write the replay page view.html")->group("Output");
  app.add_flag("--gui", o.gui, "Show the run in sumo-gui")->group("Output");
  app.add_flag("--quiet", o.quiet, "No progress on stderr")->group("Output");
  app.add_option("sumo", o.sumo, "Options for SUMO itself, behind --")->group("Output");
}

/// The command line as it was typed, for the record.
std::string command_line() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::string line;
  for (std::string argument; std::getline(file, argument, '\0');) {
    line += line.empty() ? "mvtp" : " " + argument;
  }
  return line;
}

}  // namespace

Action declare_coordinate(CLI::App& app) {
  auto options = std::make_shared<CoordinateOptions>();
  declare_options(app, *options);
  return [options] { return run_coordinate(*options, command_line()); };
}

}  // namespace mvtp
