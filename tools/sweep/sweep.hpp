#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/coordinate/options.hpp"
#include "tools/runs/shard.hpp"

namespace mvtp {

/// The command line of `mvtp sweep`.
struct SweepOptions {
  CoordinateOptions run;                   ///< what every run shares
  std::vector<std::string> run_arguments;  ///< the same as words of a command line
  std::vector<std::string> controllers = {"escot"};
  std::vector<double> scales = {1.0};        ///< of the demand
  std::vector<double> penetrations = {1.0};  ///< shares, for controllers that drive
  std::vector<std::uint32_t> seeds = {1};
  Shard shard;
  int jobs = 1;  ///< runs at a time
  std::string output;
  bool resume = false;
  bool quiet = false;
};

/// Runs every controller on every demand with every penetration and seed, each in a process of its
/// own. Rows appear in `output` as runs end.
/// @return exit code: kDone if all ran, however they ended; kNotAchieved if one crashed or was
/// refused; kInterrupted.
/// @throws InputError
[[nodiscard]] int run_sweep(const SweepOptions& options);

}  // namespace mvtp
