#include <fmt/format.h>

#include <memory>

#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/number_list.hpp"
#include "tools/cli/option_types.hpp"
#include "tools/cli/output_files.hpp"
#include "tools/cli/seed_list.hpp"
#include "tools/runs/merge_rows.hpp"
#include "tools/sweep/rows.hpp"
#include "tools/sweep/sweep.hpp"

namespace mvtp {
namespace {

/// What the command line is read into before it becomes SweepOptions.
struct SweepCommand {
  SweepOptions options;
  std::string scales = "1";
  std::string penetrations;
  std::string seeds = "1-5";
  std::string shard = "1/1";
  std::vector<std::string> files;  // of merge
};

/// What of the command line every run gets too, as words; SUMO's come last, behind "--".
std::vector<std::string> shared_arguments(const CLI::App& app, const CoordinateOptions& run) {
  std::vector<std::string> words;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group() != "Control" || option->check_lname("penetration")) continue;
    for (const std::string& value : option->results()) {
      words.push_back("--" + option->get_lnames().front() + "=" + value);
    }
  }
  if (run.end) words.push_back(fmt::format("--end={}", *run.end));
  words.push_back("--");
  for (const std::string& word : run.sumo) {
    if (word == "--scale" || word.starts_with("--scale=")) {
      throw InputError("SUMO option --scale", "mvtp sweep sets it itself; give it before the --");
    }
    words.push_back(word);
  }
  return words;
}

int merge(const SweepCommand& command) {
  check_output_files({command.options.output}, command.files);
  std::vector<std::vector<SweepRow>> lists;
  std::size_t read = 0;
  for (const std::string& file : command.files) {
    lists.push_back(read_sweep(file));
    read += lists.back().size();
  }
  const auto rows = merge_rows(lists, [](const SweepRow& row) { return key_of(row); });
  std::string text = sweep_header();
  for (const SweepRow& row : rows) text += to_csv(row);
  write_text_file(command.options.output, text);
  fmt::print(stderr, "sweep: {} rows, {} of them given more than once\n", rows.size(),
             read - rows.size());
  return kDone;
}

void add_sweep_options(CLI::App& app, SweepCommand& command) {
  const char* group = "Runs";
  app.add_option("--controllers", command.options.controllers,
                 "Controllers, as of mvtp compare [escot]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAME,NAME,...")
      ->group(group);
  app.add_option("--scale", command.scales, "Multiples of the demand, e.g. 0.5:2:0.25 or 0.5,1 [1]")
      ->type_name("LIST")
      ->group(group);
  app.add_option("--seeds", command.seeds, "Seeds, e.g. 1-5 or 1,2,7 [1-5]")
      ->type_name("LIST")
      ->group(group);
  app.add_option("--shard", command.shard,
                 "Do only part I of N, every Nth run: for several machines [1/1]")
      ->type_name("I/N")
      ->group(group);
  app.add_option("--jobs", command.options.jobs, "Runs at a time [1]")
      ->check(whole_number_between(1, 1024))
      ->type_name("N")
      ->group(group);
  app.add_option("-o,--output", command.options.output, "Results, one row per run (CSV)")
      ->type_name("FILE")
      ->group("Output");
  app.add_flag("--resume", command.options.resume,
               "Go on with a FILE that is there: only runs it lacks")
      ->group("Output");
  app.add_flag("-q,--quiet", command.options.quiet, "No progress on stderr")->group("Output");
}

CLI::App* declare_merge(CLI::App& app, SweepCommand& command) {
  CLI::App* sub = app.add_subcommand("merge", "Join the results of several shards");
  sub->footer("A run that is in several files is kept once, as it stands in the first.");
  sub->add_option("FILE", command.files, "Results of mvtp sweep")->required()->group("Input");
  sub->add_option("-o,--output", command.options.output, "Results to write, ordered")
      ->required()
      ->type_name("FILE")
      ->group("Output");
  return sub;
}

/// The options of a run, but for the share of vehicles, of which a sweep takes several.
void add_run_options(CLI::App& app, SweepCommand& command) {
  declare_run_options(app, command.options.run);
  app.get_option("--configuration")->required(false);  // merge has none
  app.remove_option(app.get_option("--penetration"));
  app.add_option("--penetration", command.penetrations,
                 "Shares of vehicles that are taken over, e.g. 0:1:0.25 or 0.2,1 [1]")
      ->type_name("LIST")
      ->group("Runs");
}

}  // namespace

Action declare_sweep(CLI::App& app) {
  const auto command = std::make_shared<SweepCommand>();
  app.footer(
      "Each run is a process of its own; a controller that drives nobody runs once for all\n"
      "penetrations. mvtp report draws the results. Exit code: 0 all ran, however they ended; 1 "
      "one\n"
      "crashed or was refused; 2 bad input; 130 interrupted: go on with --resume.");
  add_run_options(app, *command);
  add_sweep_options(app, *command);
  const CLI::App* merge_app = declare_merge(app, *command);
  app.parse_complete_callback([&app, merge_app] {
    if (merge_app->parsed()) return;
    for (const char* name : {"--configuration", "--output"}) {
      if (app.count(name) == 0) throw CLI::RequiredError(name);
    }
  });
  return [command, merge_app, &app] {
    if (merge_app->parsed()) return merge(*command);
    SweepOptions& options = command->options;
    options.scales = parse_numbers("--scale", command->scales, 0.01, 100.0);
    if (!command->penetrations.empty()) {
      options.penetrations = parse_numbers("--penetration", command->penetrations, 0.0, 1.0);
    }
    options.seeds = parse_seeds(command->seeds);
    options.shard = parse_shard(command->shard);
    options.run_arguments = shared_arguments(app, options.run);
    return run_sweep(options);
  };
}

}  // namespace mvtp
