#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/coordinate/options.hpp"

namespace mvtp {

/// The command line of `mvtp compare`.
struct CompareOptions {
  CoordinateOptions run;                   ///< what every run shares
  std::vector<std::string> run_arguments;  ///< the same as words of a command line
  std::vector<std::string> controllers;    ///< names; none: what docs/outputs.md says
  std::vector<std::uint32_t> seeds;
  int jobs = 1;  ///< runs at a time
  std::string output_dir = "compare";
  bool keep_fcd = false;
  bool quiet = false;
};

}  // namespace mvtp
