#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <thread>

#include "tools/cli/commands.hpp"
#include "tools/cli/seed_list.hpp"
#include "tools/compare/options.hpp"
#include "tools/compare/run.hpp"

namespace mvtp {
namespace {

/// What of the command line every run gets too, as words.
std::vector<std::string> shared_arguments(const CLI::App& app, const CompareOptions& options) {
  std::vector<std::string> words;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group() != "Control") continue;
    for (const std::string& value : option->results()) {
      words.push_back("--" + option->get_lnames().front() + "=" + value);
    }
  }
  if (options.run.end) words.push_back(fmt::format("--end={}", *options.run.end));
  words.push_back("--");
  words.insert(words.end(), options.run.sumo.begin(), options.run.sumo.end());
  return words;
}

}  // namespace

Action declare_compare(CLI::App& app) {
  const auto options = std::make_shared<CompareOptions>();
  const auto seeds = std::make_shared<std::string>("1-5");
  options->jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  app.footer(
      "Without --controllers: the lights of the twins NAME.static.sumocfg and "
      "NAME.actuated.sumocfg where\n"
      "they lie beside NAME.sumocfg, what NAME.sumocfg has by itself, and coordinated. On a\n"
      "parking lot: one-at-a-time, prioritized, and coordinated.");
  declare_run_options(app, options->run);
  app.add_option(
         "--controllers", options->controllers,
         "Controllers to compare, e.g. static,max-pressure,escot; where the network has no\n"
         "signals, those that need some take the twin with a light (default: see below)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAME,NAME,...")
      ->group("Input");
  app.add_option("--seeds", *seeds, "Seeds, each run under every control, e.g. 1-5 or 1,2,7")
      ->type_name("LIST")
      ->capture_default_str()
      ->group("Input");
  app.add_option("--jobs", options->jobs, "Runs at a time; the default is the number of cores")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str()
      ->group("Input");
  app.add_option("--output-dir", options->output_dir, "Folder of the results; made if missing")
      ->type_name("DIR")
      ->capture_default_str()
      ->group("Output");
  app.add_flag("--keep-fcd", options->keep_fcd, "Keep the trajectories fcd.xml of every run")
      ->group("Output");
  app.add_flag("--quiet", options->quiet, "No progress on stderr")->group("Output");
  return [options, seeds, &app] {
    options->seeds = parse_seeds(*seeds);
    options->run_arguments = shared_arguments(app, *options);
    return run_compare(*options);
  };
}

}  // namespace mvtp
