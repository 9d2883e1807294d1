#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "planner/problem/instance_file.hpp"
#include "tools/runs/shard.hpp"

namespace mvtp {

/// The command line of `mvtp bench`.
struct BenchOptions {
  std::vector<std::string> paths;  ///< instances and folders of instances
  std::string output;              ///< results.csv
  std::vector<std::string> algorithms = {"escot"};
  std::vector<std::uint32_t> seeds = {0};
  Shard shard;
  int jobs = 1;              ///< runs at a time
  double time_limit = 60.0;  ///< of each run [s]
  InstanceReadOptions reading;
  std::vector<std::string> solve_words;     ///< further options of `mvtp solve`
  std::vector<std::string> validate_words;  ///< and of `mvtp validate`
  std::string plans;                        ///< folder in which plans are kept; empty: none
  bool resume = false;
  bool quiet = false;
};

/// Runs every algorithm with every seed on every instance, each in a process of its own, and has
/// each plan refereed from its file. Rows appear in `output` as runs end.
/// @return exit code: kDone if all ran, whatever came of it; kInterrupted.
/// @throws InputError
[[nodiscard]] int run_bench(const BenchOptions& options);

}  // namespace mvtp
