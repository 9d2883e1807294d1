#include "tools/toio/options.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "planner/problem/input_error.hpp"
#include "tools/cli/instance_options.hpp"
#include "tools/cli/option_types.hpp"

namespace mvtp {
namespace {

/// An option in mm whose target is in metres.
void add_mm(CLI::App& app, const std::string& name, double& target, double low, double high,
            const std::string& description, const std::string& group) {
  app.add_option_function<double>(
         name, [&target](double mm) { target = mm / 1000.0; }, description)
      ->check(number_between(low, high))
      ->type_name("MM")
      ->group(group);
}

}  // namespace

void add_plan_options(CLI::App& app, PlanRequest& request) {
  app.add_option("PLAN", request.plan, "Plan of mvtp solve, or of others")
      ->required()
      ->type_name("FILE")
      ->group("Input");
  app.add_option("-i,--instance", request.instance,
                 "Its instance: says the vehicles, and lets the referee judge the plan [none]")
      ->type_name("FILE")
      ->group("Input");
  add_instance_options(app, request.reading);
}

void add_fit_options(CLI::App& app, std::string& mat, FitOptions& options) {
  app.add_option("--mat", mat,
                 "simple, collection-ring, collection-tiles, gesundroid, developer-1 ... "
                 "developer-12, developer-all, or a file")
      ->required()
      ->type_name("NAME")
      ->group("Mat");
  app.add_option_function<double>(
         "--scale", [&options](double mm) { options.scale = mm / 1000.0; },
         "Millimetres on the mat per metre of the plan [the most that fits]")
      ->check(number_between(1, 1000))
      ->type_name("MM")
      ->group("Mat");
  add_mm(app, "--margin-lateral", options.margins.lateral, 0, 50,
         "How far a cube may be beside its path [mm] [5]", "Mat");
  add_mm(app, "--margin-along", options.margins.along, 0, 50,
         "How far a cube may be ahead or behind on its path [mm] [6.5]", "Mat");
  add_mm(app, "--speed", options.speed, 1, 350,
         "Of the cubes where the plan is fastest [mm/s] [50]", "Cube");
  add_mm(app, "--accel", options.accel, 10, 2000, "Largest acceleration [mm/s^2] [200]", "Cube");
  add_mm(app, "--center-to-axle", options.cube.center_to_axle, 0, 10,
         "From the reported centre forwards to the wheel axle [mm] [3.8]", "Cube");
  add_mm(app, "--speed-per-unit", options.cube.speed_per_unit, 0.5, 10,
         "Of the wheels per unit of their commands [mm/s] [2.814]", "Cube");
}

void check_cube_names(const std::vector<std::string>& cubes, std::size_t robots) {
  if (cubes.empty()) return;
  if (cubes.size() != robots) {
    throw InputError("--cube", fmt::format("names {} cubes for {} robots; name one for each robot, "
                                           "in their order, or none",
                                           cubes.size(), robots));
  }
  for (auto name = cubes.begin(); name != cubes.end(); ++name) {
    if (std::find(cubes.begin(), name, *name) == name) continue;
    throw InputError("--cube",
                     fmt::format("names \"{}\" twice; name another cube for each robot", *name));
  }
}

}  // namespace mvtp
