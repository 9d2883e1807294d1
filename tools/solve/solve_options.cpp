#include "tools/solve/solve_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <string>

#include "tools/cli/option_types.hpp"

namespace mvtp {

void add_limit_options(CLI::App& app, SolveOptions& options, double& time_limit) {
  app.add_option("--time-limit", time_limit, "For all runs together [s] [60]")
      ->type_name("S")
      ->check(positive_number)
      ->group(kSearchGroup);
  app.add_option("--runs", options.runs,
                 "Tries with seeds N, N+1, ...; the first success counts [1]")
      ->type_name("N")
      ->check([](const std::string& text) {
        const bool positive = text.find_first_not_of("0123456789") == std::string::npos &&
                              text.find_first_not_of('0') != std::string::npos;
        return positive ? std::string() : "is \"" + text + "\"; give a whole number > 0";
      })
      ->group(kSearchGroup);
  app.add_option("--gap", options.gap,
                 "escot-star stops once the makespan is so close to its lower bound [0.01]")
      ->type_name("PART")
      ->check(number_between(0.0, 1e6))
      ->group(kSearchGroup);
  app.add_option("--threads", options.threads, "Searchers of escot-star side by side [1]")
      ->type_name("N")
      ->check(whole_number_between(1, 64))
      ->group(kSearchGroup);
  const std::map<std::string, PbcrScore> scores{{"paper", PbcrScore::kPaper},
                                                {"strengthened", PbcrScore::kStrengthened}};
  add_choice(app, "--pbcr", options.pbcr, scores,
             "What PBCR ranks by, alone and in escot [strengthened]")
      ->group(kSearchGroup);
  app.add_option("--run-time-limit", options.run_time_limit, "For each run [s] [the time limit]")
      ->type_name("S")
      ->check(positive_number)
      ->group(kSearchGroup);
}

void add_search_options(CLI::App& app, SolveOptions& options, double& time_limit) {
  app.add_option("-a,--algorithm", options.algorithm, "What plans [escot]")
      ->type_name(fmt::format("{}", fmt::join(algorithm_names(), "|")))
      ->check(known_algorithm)
      ->group(kSearchGroup);
  app.add_option("--seed", options.seed, "Of the random choices [0]")
      ->type_name("N")
      ->check(whole_number_between(0, std::numeric_limits<std::int64_t>::max()))
      ->group(kSearchGroup);
  add_limit_options(app, options, time_limit);
}

std::string known_algorithm(const std::string& name) {
  static const auto kCheck = one_of(algorithm_names());
  return kCheck(name);
}

}  // namespace mvtp
