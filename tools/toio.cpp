#include <fmt/format.h>

#include <memory>

#include "tools/commands.hpp"
#include "tools/toio/load.hpp"
#include "tools/toio/options.hpp"

namespace mvtp {
namespace {

/// A sub-command of `mvtp toio` and what it does.
struct Part {
  const CLI::App* app;
  Action action;
};

struct FitCommand {
  PlanRequest plan;
  std::string mat;
  FitOptions options;
};

double mm(double metres) { return metres * 1000.0; }

int fit_plan(const FitCommand& command) {
  const LoadedPlan plan = load_plan(command.plan);
  const Mat mat = find_mat(command.mat);
  const Fit fit = fit_to_mat(plan.robots, plan.dt, mat, command.options);
  if (!fit.problem.empty()) {
    fmt::print("does not fit: {}; smallest mat that fits: {}\n", fit.problem,
               fit.smallest_mat.empty() ? "none" : fit.smallest_mat);
    return kNotAchieved;
  }
  fmt::print("fits {}: {:.1f} mm per metre of the plan (true body from {:.1f}, mat up to {:.1f})\n",
             mat.name, mm(fit.frame.scale), mm(fit.least_scale), mm(fit.most_scale));
  fmt::print("speed-up {:.2f}: {:.0f} mm/s (at least {:.0f}), {}{}\n", fit.speedup,
             mm(command.options.speed), mm(fit.least_speed),
             fit.facing == Facing::kTailFirst ? "tail first" : "nose first",
             fit.frame.quarter_turns == 1 ? ", turned by a quarter" : "");
  return kDone;
}

Part declare_fit(CLI::App& parent) {
  CLI::App* app = parent.add_subcommand("fit", "Does a plan fit a mat at true body size?");
  const auto command = std::make_shared<FitCommand>();
  app->footer("Exit code: 0 it fits, 1 it does not, 2 bad input.");
  add_plan_options(*app, command->plan);
  add_fit_options(*app, command->mat, command->options);
  return {app, [command] { return fit_plan(*command); }};
}

}  // namespace

Action declare_toio(CLI::App& app) {
  app.require_subcommand(1);
  const std::vector<Part> parts = {declare_fit(app)};
  return [parts] {
    for (const Part& part : parts) {
      if (part.app->parsed()) return part.action();
    }
    return int(kBadInput);
  };
}

}  // namespace mvtp
