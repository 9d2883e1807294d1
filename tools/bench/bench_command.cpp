#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>

#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "planner/problem/vehicle_file.hpp"
#include "tools/bench/bench.hpp"
#include "tools/bench/results.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/instance_options.hpp"
#include "tools/cli/option_types.hpp"
#include "tools/cli/output_files.hpp"
#include "tools/cli/seed_list.hpp"
#include "tools/solve/solve_options.hpp"

namespace mvtp {
namespace {

/// What the command line is read into before it becomes BenchOptions.
struct BenchCommand {
  BenchOptions options;
  std::string algorithms = "escot";
  std::string seeds = "0";
  std::string shard = "1/1";
  SolveOptions solving;  // checked here, handed on as words
};

std::vector<std::string> parse_algorithms(const std::string& text) {
  std::vector<std::string> names;
  for (const std::string& name : CLI::detail::split(text, ',')) {
    const std::string problem = known_algorithm(name);
    if (!problem.empty()) throw InputError("--algorithms", problem);
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return names;
}

/// Each run would be refused.
void reject_unknown_vehicle(const InstanceReadOptions& reading) {
  (void)read_preset("--vehicle", reading.vehicle_preset.value_or("escot"));
}

/// What the user gave of the options of these groups, as words for a child.
std::vector<std::string> words_of(const CLI::App& app, const std::vector<std::string>& groups) {
  std::vector<std::string> words;
  for (const CLI::Option* option : app.get_options()) {
    if (std::ranges::find(groups, option->get_group()) == groups.end()) continue;
    for (const std::string& value : option->results()) {
      words.push_back("--" + option->get_lnames().front() + "=" + value);
    }
  }
  return words;
}

struct MergeCommand {
  std::vector<std::string> files;
  std::string output;
};

int merge(const MergeCommand& command) {
  check_output_files({command.output}, command.files);
  std::vector<std::vector<ResultRow>> lists;
  std::size_t read = 0;
  for (const std::string& file : command.files) {
    lists.push_back(read_results(file));
    read += lists.back().size();
  }
  const std::vector<ResultRow> rows = merge_results(lists);
  std::string text = results_header();
  for (const ResultRow& row : rows) text += to_csv(row);
  write_text_file(command.output, text);
  fmt::print(stderr, "bench: {} rows, {} of them given more than once\n", rows.size(),
             read - rows.size());
  return kDone;
}

CLI::App* declare_merge(CLI::App& app, MergeCommand& command) {
  CLI::App* sub = app.add_subcommand("merge", "Join the results of several shards");
  sub->footer("A run that is in several files is kept once, as it stands in the first.");
  sub->add_option("FILE", command.files, "Results of mvtp bench")->required()->group("Input");
  sub->add_option("-o,--output", command.output, "Results to write, ordered by instance")
      ->required()
      ->type_name("FILE")
      ->group("Output");
  return sub;
}

void add_run_options(CLI::App& app, BenchCommand& command) {
  const char* group = "Runs";
  app.add_option("--algorithms", command.algorithms, "What plans, e.g. escot,pbcr [escot]")
      ->type_name(fmt::format("{}", fmt::join(algorithm_names(), ",")))
      ->group(group);
  app.add_option("--seeds", command.seeds, "Of the random choices, e.g. 0-4 or 0,1,2 [0]")
      ->type_name("LIST")
      ->group(group);
  app.add_option("--shard", command.shard,
                 "Do only part I of N, every Nth instance: for several machines [1/1]")
      ->type_name("I/N")
      ->group(group);
  app.add_option("--jobs", command.options.jobs,
                 "Runs at a time; run times are fair if each has a core of its own [1]")
      ->check(whole_number_between(1, 1024))
      ->type_name("N")
      ->group(group);
}

void add_output_options(CLI::App& app, BenchOptions& options) {
  const char* group = "Output";
  app.add_option("-o,--output", options.output, "Results, one row per run (CSV)")
      ->type_name("FILE")
      ->group(group);
  app.add_flag("--resume", options.resume, "Go on with a FILE that is there: only runs it lacks")
      ->group(group);
  app.add_option("--plans", options.plans, "Folder in which plans are kept [none]")
      ->type_name("DIR")
      ->group(group);
  app.add_flag("-q,--quiet", options.quiet, "No progress and summary on stderr")->group(group);
}

}  // namespace

Action declare_bench(CLI::App& app) {
  const auto command = std::make_shared<BenchCommand>();
  const auto merging = std::make_shared<MergeCommand>();
  app.footer(
      "Each run is a process of its own, and each plan is judged by the referee from its file.\n"
      "Exit code: 0 all ran, solved or not; 2 bad input; 130 interrupted: go on with --resume.");
  app.add_option("PATH", command->options.paths, "Instances, and folders of instances")
      ->group("Input");
  add_run_options(app, *command);
  add_limit_options(app, command->solving, command->options.time_limit);
  add_instance_options(app, command->options.reading);
  add_collision_option(app, command->solving.collision);
  add_instance_rules(app, command->options.reading);
  add_output_options(app, command->options);
  const CLI::App* merge_app = declare_merge(app, *merging);
  app.parse_complete_callback([&app, merge_app, command] {
    if (merge_app->parsed()) return;
    for (const char* name : {"PATH", "--output"}) {
      if (app.count(name) == 0) throw CLI::RequiredError(name);
    }
  });
  return [command, merging, merge_app, &app] {
    if (merge_app->parsed()) return merge(*merging);
    BenchOptions& options = command->options;
    options.algorithms = parse_algorithms(command->algorithms);
    options.seeds = parse_seeds(command->seeds);
    options.shard = parse_shard(command->shard);
    reject_unknown_vehicle(options.reading);
    options.solve_words = words_of(app, {kSearchGroup, kInstanceGroup, kRulesGroup});
    options.validate_words = words_of(app, {kInstanceGroup, kRulesGroup});
    return run_bench(options);
  };
}

}  // namespace mvtp
