#pragma once

#include <string>

#include "planner/solve.hpp"

namespace CLI {
class App;
}

namespace mvtp {

/// The options that `solve` takes and `bench` hands on to it, in this group.
inline constexpr const char* kSearchGroup = "Search";

/// --time-limit, --runs, --run-time-limit, --gap, --threads and --pbcr. The targets must outlive
/// the parsing.
void add_limit_options(CLI::App& app, SolveOptions& options, double& time_limit);

/// These, --algorithm and --seed.
void add_search_options(CLI::App& app, SolveOptions& options, double& time_limit);

/// For CLI::Option::check(): one of algorithm_names().
[[nodiscard]] std::string known_algorithm(const std::string& name);

}  // namespace mvtp
