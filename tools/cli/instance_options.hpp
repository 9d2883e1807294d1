#pragma once

#include <string>
#include <vector>

#include "planner/problem/instance_file.hpp"

namespace CLI {
class App;
}

namespace mvtp {

/// The groups of these options, for commands that hand them on.
inline constexpr const char* kInstanceGroup = "Instance";
inline constexpr const char* kRulesGroup = "Rules";

/// The options by which every command that reads an instance lets the user say how to read it.
/// `options` must outlive the parsing.
void add_instance_options(CLI::App& app, InstanceReadOptions& options);

/// --initial-overlap refuse|allow.
void add_instance_rules(CLI::App& app, InstanceReadOptions& options);

/// "; allowed: goal of agent2 in obstacles[7] by 0.02 m, ...", for the end of a line; empty if
/// nothing is exempt.
[[nodiscard]] std::string exemptions_text(const std::vector<std::string>& exemptions);

/// --collision continuous|steps.
void add_collision_option(CLI::App& app, CollisionRule& rule);

}  // namespace mvtp
