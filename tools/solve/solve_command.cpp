#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "planner/problem/check_instance.hpp"
#include "planner/problem/plan_file.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/instance_options.hpp"
#include "tools/cli/interrupt.hpp"
#include "tools/cli/option_types.hpp"
#include "tools/cli/output_files.hpp"
#include "tools/cli/progress.hpp"
#include "tools/cli/version.hpp"
#include "tools/solve/solve_and_judge.hpp"
#include "tools/solve/solve_options.hpp"

namespace mvtp {
namespace {

struct SolveCommand {
  std::string instance;
  std::string output;
  std::string statistics;
  InstanceReadOptions reading;
  SolveOptions solving;
  double time_limit = 60.0;
  bool quiet = false;
};

/// Writes how it went, solved or not, as a plan without trajectories.
void write_statistics(const SolveCommand& command, const Statistics& statistics) {
  if (command.statistics.empty()) return;
  write_plan({.statistics = statistics, .names = {}, .trajectories = {}}, command.statistics,
             command.reading.yaw);
}

/// @throws InputError if the instance cannot be solved, whoever plans.
void refuse_blocked(const SolveCommand& command, const Instance& instance) {
  const std::vector<InputError> problems = check_instance(instance, command.instance);
  if (problems.empty()) return;
  Statistics statistics;
  statistics.status = to_string(Status::kInfeasible);
  statistics.algorithm = command.solving.algorithm;
  statistics.seed = command.solving.seed;
  statistics.dt = instance.dt;
  statistics.version = version();
  statistics.reason = problems.front().what();
  write_statistics(command, statistics);
  throw problems.front();
}

/// What was found is written, whoever ended the search.
int report(const SolveCommand& command, const Plan& plan, bool interrupted) {
  const Statistics& s = plan.statistics;
  write_statistics(command, s);
  if (s.status != to_string(Status::kSolved)) {
    fmt::print(stderr, "mvtp: {}: {} ({}): {}\n", command.instance,
               interrupted ? "interrupted, and not solved" : "not solved", s.status, s.reason);
    return interrupted ? kInterrupted : kNotAchieved;
  }
  if (!command.output.empty()) write_plan(plan, command.output, command.reading.yaw);
  if (!command.quiet) {
    fmt::print(
        "solved: {} agents, makespan {} steps = {:.2f} s (at least {:.2f} s), flowtime "
        "{:.2f} s, found in {:.3f} s{}{}\n",
        plan.names.size(), s.makespan_steps, s.makespan, s.lower_bound, s.flowtime, s.runtime,
        command.solving.runs > 1 ? fmt::format(" with seed {}", s.seed) : "",
        exemptions_text(s.initial_overlaps));
  }
  if (!interrupted) return kDone;
  fmt::print(stderr, "mvtp: {}: interrupted; this is the best plan so far\n", command.instance);
  return kInterrupted;
}

int solve_file(const SolveCommand& command) {
  const Deadline deadline = Deadline::in(command.time_limit);
  check_output_files({command.output, command.statistics}, {command.instance});
  const Instance instance = read_instance(command.instance, command.reading);
  refuse_blocked(command, instance);

  const NotedInterrupt interrupt;
  std::optional<TimeProgress> progress(std::in_place, "solve", command.time_limit, command.quiet);
  const Plan plan = solve_and_judge(instance, command.solving, deadline, interrupt.seen());
  progress.reset();
  return report(command, plan, interrupt.seen());
}

}  // namespace

Action declare_solve(CLI::App& app) {
  const auto command = std::make_shared<SolveCommand>();
  app.footer(
      "The plan is written only if every robot reaches its goal and the referee finds it valid.\n"
      "Same instance, options and seed give the same plan unless the time limit ends the search.\n"
      "Exit code: 0 solved, 1 not solved, 2 bad input, 130 interrupted: what is found is written.");
  app.add_option("-i,--instance", command->instance, "Instance (CL-CBS/CSDO YAML, Guo-Yu JSON)")
      ->required()
      ->type_name("FILE")
      ->group("Input");
  app.add_option("-o,--output", command->output, "Plan to write (CL-CBS YAML) [none]")
      ->type_name("FILE")
      ->group("Output");
  app.add_option("--statistics", command->statistics,
                 "How it went, solved or not (YAML: a plan without trajectories) [none]")
      ->type_name("FILE")
      ->group("Output");
  app.add_flag("-q,--quiet", command->quiet, "Print nothing when solved, and no progress")
      ->group("Output");
  add_search_options(app, command->solving, command->time_limit);
  add_instance_options(app, command->reading);
  add_collision_option(app, command->solving.collision);
  add_instance_rules(app, command->reading);
  return [command] { return solve_file(*command); };
}

}  // namespace mvtp
