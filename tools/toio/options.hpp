#pragma once

#include <string>
#include <vector>

#include "tools/toio/plan/load.hpp"

namespace CLI {
class App;
}

namespace mvtp {

/// The plan, its instance, and how to read them.
void add_plan_options(CLI::App& app, PlanRequest& request);

/// The mat, and how the plan is laid on it.
void add_fit_options(CLI::App& app, std::string& mat, FitOptions& options);

/// @throws InputError unless `cubes` is empty or names another one for each robot.
void check_cube_names(const std::vector<std::string>& cubes, std::size_t robots);

}  // namespace mvtp
