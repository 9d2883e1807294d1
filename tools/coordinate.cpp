#include <memory>

#include "tools/command_line.hpp"
#include "tools/commands.hpp"
#include "tools/coordinate/run.hpp"
#include "tools/option_types.hpp"

namespace mvtp {
namespace {

void declare_options(CLI::App& app, CoordinateOptions& o) {
  declare_run_options(app, o);
  app.add_option("--seed", o.seed, "Seed of SUMO's random numbers and of ours")
      ->check(whole_number_between(0, 2147483647))
      ->capture_default_str()
      ->group("Input");
  app.add_option("--remote", o.remote,
                 "Join a SUMO that was started on the same scenario with --remote-port PORT,\n"
                 "instead of starting one; its options, seed and outputs are its own")
      ->type_name("HOST:PORT")
      ->group("Input");
  app.add_option("--order", o.order, "Of this client of it, from 1: who speaks first in a step")
      ->check(whole_number_between(1, 1000))
      ->capture_default_str()
      ->group("Input");
  app.add_option("--num-clients", o.num_clients, "Clients that it waits for, as it was told")
      ->check(whole_number_between(1, 1000))
      ->capture_default_str()
      ->group("Input");
  std::string meanings = "Who drives:";
  std::string names;
  for (const ControllerKind& c : controller_kinds()) {
    meanings += "\n" + c.name + ": " + c.meaning;
    names += (names.empty() ? "" : "|") + c.name;
  }
  app.add_option("--controller", o.controller, meanings)
      ->type_name(names)
      ->capture_default_str()
      ->group("Control");
  app.add_option("--output-dir", o.output_dir, "Folder of the results; made if missing")
      ->type_name("DIR")
      ->capture_default_str()
      ->group("Output");
  app.add_flag("--no-view", o.no_view, "Do not write the replay page view.html")->group("Output");
  app.add_flag("--no-fcd", o.no_fcd, "Do not write the trajectories fcd.xml")->group("Output");
  app.add_option("--dump-instances", o.dump_instances,
                 "Folder for decisions at junctions as instance files, which mvtp solve reads")
      ->type_name("DIR")
      ->group("Output");
  app.add_option("--dump-every", o.dump_every,
                 "Of the decisions with at least two vehicles, dump every so many")
      ->check(whole_number_between(1, 1000000000))
      ->capture_default_str()
      ->group("Output");
  app.add_flag("--gui", o.gui, "Show the run in sumo-gui")->group("Output");
  app.add_flag("--quiet", o.quiet, "No progress on stderr, no table")->group("Output");
}

}  // namespace

Action declare_coordinate(CLI::App& app) {
  auto options = std::make_shared<CoordinateOptions>();
  declare_options(app, *options);
  return [options] { return run_coordinate(*options, command_line()); };
}

}  // namespace mvtp
