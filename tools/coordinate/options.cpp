#include "tools/coordinate/options.hpp"

#include "planner/problem/input_error.hpp"
#include "tools/cli/option_types.hpp"

namespace mvtp {
namespace {

/// Who of the traffic is automated; the others are human-driven.
void declare_share(CLI::App& app, CoordinateOptions& o) {
  app.add_option("--penetration", o.penetration,
                 "Share of the vehicles that are automated and taken over at junctions, by a hash\n"
                 "of id and seed; the others keep SUMO's drivers")
      ->check(number_between(0.0, 1.0))
      ->capture_default_str()
      ->group("Control");
  app.add_option("--coordinate-types", o.coordinate_types,
                 "Vehicle types of which vehicles are taken over, A,B or repeated (default: all)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("ID,ID,...")
      ->group("Control");
  app.add_option("--human-types", o.human_types,
                 "Vehicle types that keep SUMO's drivers, A,B or repeated (default: none)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("ID,ID,...")
      ->group("Control");
  app.add_option("--priority-types", o.priority_types,
                 "Vehicle types whose time counts 20 times at junctions, A,B or repeated, as that\n"
                 "of vehicles of SUMO's class emergency always does (buses: 4 times)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("ID,ID,...")
      ->group("Control");
  app.add_option("--signal-timing", o.signal_timing,
                 "Lights for human-driven vehicles: real (yellow 3 s at 50 km/h, 1 s all red, 5 s\n"
                 "least green) or instant (they turn at once)")
      ->type_name("real|instant")
      ->check(one_of({"real", "instant"}))
      ->capture_default_str()
      ->group("Control");
  app.add_option(
         "--intent", o.intent,
         "What is known of where human drivers turn: their routes (known), any movement\n"
         "of their lane until they are behind its line (lane), or of their road until they\n"
         "may not change lanes any more (none)")
      ->type_name("known|lane|none")
      ->check(one_of({"known", "lane", "none"}))
      ->capture_default_str()
      ->group("Control");
  app.add_option("--human-faults", o.human_faults,
                 "Share of the human drivers who misbehave once before a junction, by seed: run a\n"
                 "red light, stop dead, change lanes at once, or react late")
      ->check(number_between(0.0, 1.0))
      ->capture_default_str()
      ->group("Control");
}

/// What goes wrong, and what is reckoned with.
void declare_faults(CLI::App& app, CoordinateOptions& o) {
  app.add_option(
         "--faults", o.faults,
         "What goes wrong at junctions, by seed: of messages, each way, delay=S and loss=SHARE\n"
         "(command-delay, report-loss, ...: one way); of reports, position=M and heading=DEG; of\n"
         "driving, actuation=M (standard deviations); of vehicles, shares that stop dead inside a\n"
         "junction, stops=SHARE (stops-for=S, 60), or ignore their plans there, ignores=SHARE, "
         "and\n"
         "stop=VEHICLE@S, ignore=VEHICLE@S; late=SHARE of the decisions; sumo-ends=S")
      ->type_name("KEY=VALUE,...")
      ->group("Control");
  app.add_option("--assume-noise", o.assume_noise,
                 "What plans are to bear, in the keys of --faults for messages, reports and\n"
                 "driving; faults: what --faults says. Lead and safety distances follow from it\n"
                 "(default: nothing)")
      ->type_name("KEY=VALUE,...|faults")
      ->group("Control");
}

/// Options of planning, on roads and on lots.
void declare_planning(CLI::App& app, CoordinateOptions& o) {
  app.add_option("--tries", o.tries,
                 "Orders of passage tried per replan (0: first come, first served)")
      ->check(number_between(0, 100000))
      ->capture_default_str()
      ->group("Control");
  app.add_option("--threads", o.threads,
                 "Threads that plan and watch; the results do not depend on it "
                 "(0: one per core)")
      ->check(whole_number_between(0, 1024))
      ->capture_default_str()
      ->group("Control");
  app.add_option("--parking", o.parking, "How to stand in slots: forward, reverse, or any")
      ->type_name("forward|reverse|any")
      ->check(one_of({"forward", "reverse", "any"}))
      ->capture_default_str()
      ->group("Control");
  app.add_option("--break-down", o.breakdowns,
                 "Vehicle that stops for good on the parking lot, and when [s]; repeatable")
      ->type_name("VEHICLE@SECONDS")
      ->group("Control");
  app.add_option("--replan-budget-ms", o.replan_budget_ms,
                 "Processor time for the plan of one group of vehicles [ms]; a later plan is\n"
                 "dropped. 0: no planning, as if the planner were dead (default: the decision\n"
                 "period, 500)")
      ->check(number_between(0.0, 1e9))
      ->group("Control");
  app.add_option("--replan-budget-from", o.replan_budget_from,
                 "Simulated time from which the budget holds [s]")
      ->check(number_between(0.0, 1e9))
      ->capture_default_str()
      ->group("Control");
}

}  // namespace

const ControllerKind& controller_named(const std::string& option, const std::string& name) {
  if (const ControllerKind* kind = find_controller(name)) return *kind;
  std::vector<std::string> names;
  for (const ControllerKind& kind : controller_kinds()) names.push_back(kind.name);
  throw InputError(option + " " + name, "is no controller; " + did_you_mean(name, names) +
                                            "there are " + CLI::detail::join(names, ", "));
}

void declare_run_options(CLI::App& app, CoordinateOptions& o) {
  app.add_option("-c,--configuration", o.configuration, "SUMO scenario (*.sumocfg)")
      ->required()
      ->type_name("FILE")
      ->group("Input");
  app.add_option("--end", o.end,
                 "Simulated time at which to end [s] (default: that of the scenario, else\n"
                 "when all have arrived)")
      ->check(number_between(0.0, 1e9))
      ->group("Input");
  app.add_option("--junction", o.junctions,
                 "Junctions to coordinate, A,B or repeated, with those less than 50 m from\n"
                 "one of them (default: all with conflicting connections)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("ID,ID,...")
      ->group("Control");
  app.add_option("--zone-radius", o.zone_radius,
                 "Takeover this far before the stop line; more where limits exceed 73 km/h [m]")
      ->check(number_between(20.0, 1000.0))
      ->capture_default_str()
      ->group("Control");
  app.add_option(
         "--max-lateral-accel", o.max_lateral_accel,
         "Limit in bends for every vehicle, SUMO's too [m/s^2] (0: the lanes' speed limits)")
      ->check([](const std::string& text) {
        if (number_between(0.0, 0.0)(text).empty()) return std::string();
        std::string problem = number_between(0.1, 100.0)(text);
        return problem.empty() ? problem : problem + ", or 0";
      })
      ->capture_default_str()
      ->group("Control");
  app.add_option("--margin-along", o.margin_along, "Safety distance ahead and behind, in all [m]")
      ->check(number_between(0.0, 10.0))
      ->capture_default_str()
      ->group("Control");
  app.add_option("--margin-across", o.margin_across, "Safety distance at the sides, in all [m]")
      ->check(number_between(0.0, 1.3))
      ->capture_default_str()
      ->group("Control");
  declare_share(app, o);
  declare_planning(app, o);
  declare_faults(app, o);
  app.add_option("sumo", o.sumo, "Options for SUMO itself, behind --")->group("Input");
}

void declare_coordinate_options(CLI::App& app, CoordinateOptions& o) {
  declare_run_options(app, o);
  app.add_option("--seed", o.seed, "Seed of SUMO's and mvtp's random numbers")
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

}  // namespace mvtp
