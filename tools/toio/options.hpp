#pragma once

#include <CLI/CLI.hpp>

#include "tools/toio/load.hpp"

namespace mvtp {

/// The plan, its instance, and how to read them.
void add_plan_options(CLI::App& app, PlanRequest& request);

/// The mat, and how the plan is laid on it.
void add_fit_options(CLI::App& app, std::string& mat, FitOptions& options);

}  // namespace mvtp
