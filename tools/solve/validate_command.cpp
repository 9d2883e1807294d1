#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "planner/problem/initial_overlap.hpp"
#include "planner/problem/instance_file.hpp"
#include "planner/problem/metrics.hpp"
#include "planner/problem/plan_file.hpp"
#include "planner/problem/validate.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/instance_options.hpp"

namespace mvtp {
namespace {

struct ValidateOptions {
  std::string instance;
  std::string plan;
  InstanceReadOptions reading;
  CollisionRule collision = CollisionRule::kContinuous;
  bool quiet = false;
};

/// One line per violation, or one that says what was found valid.
int validate(const ValidateOptions& options) {
  Instance instance = read_instance(options.instance, options.reading);
  Plan plan = read_plan(options.plan, {options.reading.yaw, instance.dt});
  if (options.reading.dt) plan.statistics.dt = *options.reading.dt;
  const bool other_vehicles = !options.reading.vehicle_preset && take_vehicles(plan, instance);

  const std::vector<Violation> violations = find_violations(instance, plan, options.collision);
  if (!options.quiet) {
    for (const Violation& v : violations) fmt::print("{}: {}\n", to_string(v.rule), v.message);
    if (violations.empty()) {
      fill_in_durations(plan);
      fmt::print("valid: {} agents, makespan {} steps = {:.2f} s, flowtime {:.2f} s{}{}\n",
                 plan.names.size(), plan.statistics.makespan_steps, plan.statistics.makespan,
                 plan.statistics.flowtime,
                 other_vehicles ? ", with the vehicles of the plan in place of the instance's" : "",
                 exemptions_text(exemptions_of(instance)));
    }
  }
  return violations.empty() ? kDone : kNotAchieved;
}

}  // namespace

Action declare_validate(CLI::App& app) {
  const auto options = std::make_shared<ValidateOptions>();
  app.footer(
      "Prints one line per broken rule, or \"valid: ...\". Exit code: 0 valid, 1 invalid, 2 bad "
      "input.");
  app.add_option("-i,--instance", options->instance, "Instance (CL-CBS/CSDO YAML, Guo-Yu JSON)")
      ->required()
      ->type_name("FILE")
      ->group("Input");
  app.add_option("-s,--plan", options->plan, "Plan to judge (CL-CBS YAML, Guo-Yu JSON)")
      ->required()
      ->type_name("FILE")
      ->group("Input");
  add_instance_options(app, options->reading);
  add_collision_option(app, options->collision);
  add_instance_rules(app, options->reading);
  app.add_flag("-q,--quiet", options->quiet, "Print nothing; the exit code tells")->group("Output");
  return [options] { return validate(*options); };
}

}  // namespace mvtp
