#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <memory>
#include <thread>

#include "planner/problem/input_error.hpp"
#include "tools/commands.hpp"
#include "tools/compare_options.hpp"
#include "tools/compare_run.hpp"

namespace mvtp {
namespace {

constexpr std::size_t kMaxSeeds = 1000;

[[noreturn]] void refuse_seeds(const std::string& text) {
  throw InputError("--seeds", fmt::format("is \"{}\"; give at most {} whole numbers as in 1-5 or "
                                          "1,2,7",
                                          text, kMaxSeeds));
}

std::uint32_t parse_seed(std::string_view word, const std::string& text) {
  std::uint32_t seed = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), seed);
  if (error != std::errc() || end != word.data() + word.size() || seed > 2147483647U) {
    refuse_seeds(text);
  }
  return seed;
}

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

std::vector<std::uint32_t> parse_seeds(const std::string& text) {
  std::vector<std::uint32_t> seeds;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    const std::string_view word = std::string_view(text).substr(begin, comma - begin);
    const std::size_t dash = word.find('-');
    const std::uint32_t first = parse_seed(word.substr(0, dash), text);
    const std::uint32_t last =
        dash == std::string_view::npos ? first : parse_seed(word.substr(dash + 1), text);
    if (last < first || last - first >= kMaxSeeds) refuse_seeds(text);
    for (std::uint32_t seed = first; seed <= last; ++seed) seeds.push_back(seed);
    begin = comma + 1;
  }
  std::ranges::sort(seeds);
  seeds.erase(std::unique(seeds.begin(), seeds.end()), seeds.end());
  if (seeds.size() > kMaxSeeds) refuse_seeds(text);
  return seeds;
}

Action declare_compare(CLI::App& app) {
  const auto options = std::make_shared<CompareOptions>();
  const auto seeds = std::make_shared<std::string>("1-5");
  options->jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  app.footer(
      "The controls: the lights of the twins NAME.static.sumocfg and NAME.actuated.sumocfg where\n"
      "they lie beside NAME.sumocfg, what NAME.sumocfg has by itself, and coordinated.");
  declare_run_options(app, options->run);
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
