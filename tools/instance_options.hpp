#pragma once

#include <CLI/CLI.hpp>

#include "planner/problem/instance_file.hpp"

namespace mvtp {

/// The options by which every command that reads an instance lets the user say how to read it.
/// `options` must outlive the parsing.
void add_instance_options(CLI::App& app, InstanceReadOptions& options);

/// --collision continuous|steps.
void add_collision_option(CLI::App& app, CollisionRule& rule);

}  // namespace mvtp
