#include "tools/coordinate/options.hpp"

#include "planner/problem/input_error.hpp"
#include "tools/option_types.hpp"

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
  app.add_option("--signal-timing", o.signal_timing,
                 "Lights for human-driven vehicles: real (yellow 3 s at 50 km/h, 1 s all red, 5 s\n"
                 "least green) or instant (they turn at once)")
      ->check(CLI::IsMember({"real", "instant"}))
      ->capture_default_str()
      ->group("Control");
  app.add_option("--intent", o.intent,
                 "What is known of where human drivers turn: their routes (known), any movement\n"
                 "of their lane until they are behind its line (lane), or of their road until they\n"
                 "may not change lanes any more (none)")
      ->check(CLI::IsMember({"known", "lane", "none"}))
      ->capture_default_str()
      ->group("Control");
  app.add_option("--human-faults", o.human_faults,
                 "Share of the human drivers who misbehave once before a junction, by seed: run a\n"
                 "red light, stop dead, change lanes at once, or react late")
      ->check(number_between(0.0, 1.0))
      ->capture_default_str()
      ->group("Control");
}

/// Options of planning, on roads and on lots.
void declare_planning(CLI::App& app, CoordinateOptions& o) {
  app.add_option("--tries", o.tries, "Orders of passage tried per replan (0: order of arrival)")
      ->check(number_between(0, 100000))
      ->capture_default_str()
      ->group("Control");
  app.add_option("--threads", o.threads,
                 "Threads that plan; the results do not depend on it "
                 "(0: one per core)")
      ->check(whole_number_between(0, 1024))
      ->capture_default_str()
      ->group("Control");
  app.add_option("--parking", o.parking, "How to stand in slots: forward, reverse, or any")
      ->check(CLI::IsMember({"forward", "reverse", "any"}))
      ->capture_default_str()
      ->group("Control");
  app.add_option("--break-down", o.breakdowns,
                 "Vehicle that stops for good on the parking lot, and when [s]; repeatable")
      ->type_name("VEHICLE@SECONDS")
      ->group("Control");
  app.add_option("--replan-budget-ms", o.replan_budget_ms,
                 "Drop plans that take longer [ms]; 0: no planning, as if the planner were dead "
                 "(default: no limit)")
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
  std::string names;
  for (const ControllerKind& kind : controller_kinds()) {
    names += (names.empty() ? "" : ", ") + kind.name;
  }
  throw InputError(option + " " + name, "is no controller; there are " + names);
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
  app.add_option("--zone-radius", o.zone_radius, "Takeover this far before the stop line [m]")
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
  app.add_option("sumo", o.sumo, "Options for SUMO itself, behind --")->group("Input");
}

}  // namespace mvtp
