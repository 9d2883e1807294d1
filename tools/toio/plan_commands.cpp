#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "planner/problem/text_file.hpp"
#include "tools/cli/option_types.hpp"
#include "tools/cli/output_files.hpp"
#include "tools/toio/commands.hpp"
#include "tools/toio/options.hpp"
#include "tools/toio/plan/check.hpp"
#include "tools/toio/plan/export.hpp"

namespace mvtp {
namespace {

struct PlanCommand {
  PlanRequest plan;
  std::string mat;
  FitOptions fitting;
  ExportOptions exporting;
  std::string output;
  std::string csv;
  bool quiet = false;
};

/// What both commands find out: how the plan lies on the mat, and the run.
struct Outcome {
  Fit fit;
  Exported exported;
  std::string problem;  ///< why there is no run
};

Outcome lay_out(const PlanCommand& command) {
  const LoadedPlan plan = load_plan(command.plan);
  check_cube_names(command.exporting.cubes, plan.robots.size());
  Outcome outcome;
  outcome.fit = fit_to_mat(plan.robots, plan.dt, find_mat(command.mat), command.fitting);
  if (!outcome.fit.problem.empty()) {
    const std::string& smallest = outcome.fit.smallest_mat;
    outcome.problem = fmt::format("{}; smallest mat that fits: {}", outcome.fit.problem,
                                  smallest.empty() ? "none" : smallest);
    return outcome;
  }
  outcome.exported =
      make_run(plan.robots, plan.dt, outcome.fit, command.fitting, command.exporting);
  outcome.problem = outcome.exported.problem;
  return outcome;
}

int refuse(const std::string& problem) {
  fmt::print("does not fit: {}\n", problem);
  return kNotAchieved;
}

double duration(const ToioRun& run) {
  double end = 0.0;
  for (const RunRobot& robot : run.robots) end = std::max(end, robot.waypoints.back().time);
  return end;
}

std::size_t requirement_count(const ToioRun& run) {
  std::size_t count = 0;
  for (const RunRobot& robot : run.robots) count += robot.requirements.size();
  return count;
}

void print_fit(const PlanCommand& command, const Outcome& outcome) {
  const Fit& fit = outcome.fit;
  const ToioRun& run = outcome.exported.run;
  fmt::print("fits {}: {:.1f} mm per metre of the plan (true body from {:.1f}, mat up to {:.1f})\n",
             fit.mat.name, in_mm(fit.frame.scale), in_mm(fit.least_scale), in_mm(fit.most_scale));
  fmt::print("{} cubes, {}{}, {:.1f} s at {:.0f} mm/s (at least {:.0f}): {:.2f} times the plan\n",
             run.robots.size(), fit.facing == Facing::kTailFirst ? "tail first" : "nose first",
             fit.frame.quarter_turns == 1 ? ", turned by a quarter" : "", duration(run),
             in_mm(command.fitting.speed), in_mm(fit.least_speed), fit.speedup);
  if (run.robots.size() < 2) return;
  fmt::print("bodies pass {:.1f} mm apart at least; {} places where one waits for another\n",
             in_mm(run.clearance), requirement_count(run));
}

int fit_plan(const PlanCommand& command) {
  const Outcome outcome = lay_out(command);
  if (!outcome.problem.empty()) return refuse(outcome.problem);
  print_fit(command, outcome);
  return kDone;
}

int export_plan(const PlanCommand& command) {
  check_output_files({command.output, command.csv},
                     {command.plan.plan, command.plan.instance, command.mat});
  const Outcome outcome = lay_out(command);
  if (!outcome.problem.empty()) return refuse(outcome.problem);
  const ToioRun& run = outcome.exported.run;
  const std::vector<std::string> problems = find_problems(run);
  if (!problems.empty()) return refuse(problems.front());
  write_text_file(command.output, to_json(run));
  if (!command.csv.empty()) write_text_file(command.csv, to_csv(run));
  if (!command.quiet) print_fit(command, outcome);
  return kDone;
}

int check_run(const std::string& file) {
  const ToioRun run = read_run(file);
  const std::vector<std::string> problems = find_problems(run);
  for (const std::string& problem : problems) fmt::print("{}\n", problem);
  if (!problems.empty()) return kNotAchieved;
  fmt::print("good: {} robots on {}, {:.1f} s, {} places where one waits for another\n",
             run.robots.size(), run.desk.mat.name, duration(run), requirement_count(run));
  return kDone;
}

}  // namespace

ToioCommand declare_toio_fit(CLI::App& toio) {
  CLI::App* app = toio.add_subcommand("fit", "Does a plan fit a mat at true body size?");
  const auto command = std::make_shared<PlanCommand>();
  app->footer("Exit code: 0 it fits, 1 it does not, 2 bad input.");
  add_plan_options(*app, command->plan);
  add_fit_options(*app, command->mat, command->fitting);
  return {app, [command] { return fit_plan(*command); }};
}

ToioCommand declare_toio_export(CLI::App& toio) {
  CLI::App* app = toio.add_subcommand("export", "Write what moves the cubes: a run file");
  const auto command = std::make_shared<PlanCommand>();
  app->footer(
      "The frames in the files are for other players: right only while no cube is ever late.\n"
      "Exit code: 0 written, 1 the plan does not fit, 2 bad input.");
  add_plan_options(*app, command->plan);
  add_fit_options(*app, command->mat, command->fitting);
  app->add_option("-o,--output", command->output, "Run to write (JSON)")
      ->required()
      ->type_name("FILE")
      ->group("Output");
  app->add_option("--csv", command->csv, "Frames to write, one per line [none]")
      ->type_name("FILE")
      ->group("Output");
  app->add_flag("-q,--quiet", command->quiet, "Print nothing when written")->group("Output");
  add_choice<DriveMode>(
      *app, "--mode", command->exporting.mode,
      {{"track", DriveMode::kTrack}, {"target", DriveMode::kTarget}, {"list", DriveMode::kList}},
      "Wheel speeds, targets one by one, or lists of targets [track]")
      ->group("Frames");
  app->add_option("--mtu", command->exporting.mtu, "Of the link: how long a list may be [23]")
      ->check(whole_number_between(23, 517))
      ->type_name("BYTES")
      ->group("Frames");
  app->add_option("--segment", command->exporting.segment,
                  "Length of a segment, halved where robots pass close [s of the plan] [0.25]")
      ->check(number_between(0.01, 100))
      ->type_name("S")
      ->group("Frames");
  app->add_option("--cube", command->exporting.cubes,
                  "Name or address of the cube of each robot, in order [found at the start]")
      ->type_name("NAME")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->group("Frames");
  return {app, [command] { return export_plan(*command); }};
}

ToioCommand declare_toio_check(CLI::App& toio) {
  CLI::App* app = toio.add_subcommand("check", "Judge a run file, ours or anyone's");
  const auto file = std::make_shared<std::string>();
  app->footer("Exit code: 0 cubes may drive it, 1 they may not, 2 bad input.");
  app->add_option("RUN", *file, "Run file of mvtp toio export")
      ->required()
      ->type_name("FILE")
      ->group("Input");
  return {app, [file] { return check_run(*file); }};
}

}  // namespace mvtp
