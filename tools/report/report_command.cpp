#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "tools/bench/results.hpp"
#include "tools/cli/child_process.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/option_types.hpp"
#include "tools/cli/output_folder.hpp"
#include "tools/cli/sibling.hpp"
#include "tools/report/run_figures.hpp"
#include "tools/report/summary.hpp"
#include "tools/report/sweep_figures.hpp"
#include "tools/sweep/rows.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

struct ReportCommand {
  std::vector<std::string> results;  ///< a table, or folders of runs
  std::string folder;
  std::optional<double> time_limit;
  TimeSpaceRequest time_space;
  std::string python = "/usr/bin/python3";
};

/// Runs report.py, which lies beside the program, on the numbers in figures.json.
/// @return exit code.
int draw_figures(const ReportCommand& command) {
  constexpr int kNoMatplotlib = 3;  // exit codes of the script
  constexpr int kUnwritable = 4;
  const fs::path script = shared_file("report.py");
  if (!fs::exists(script)) throw InputError(script.string(), "is missing; install mvtp again");
  if (!fs::exists(command.python)) {
    throw InputError(
        command.python,
        "is missing: the figures need it; install python3-matplotlib, or give --python");
  }
  Job job;
  job.arguments = {command.python,
                   "-B",
                   "-E",
                   script.string(),
                   (fs::path(command.folder) / "figures.json").string(),
                   command.folder};
  int status = 0;
  const bool complete = run_jobs(std::span(&job, 1), 1, [&](std::size_t, int end) {
    status = end;
    return true;
  });
  if (!complete) return kInterrupted;
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNoMatplotlib) {
    throw InputError(command.python,
                     "has no matplotlib, which the figures need (the tables are "
                     "written); install python3-matplotlib");
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == kUnwritable) {
    throw InputError(command.folder,
                     "the figures cannot be written there: is the disk full? Make room, or choose "
                     "another --output-dir");
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw InputError(command.folder, "the figures could not be drawn there; the reason is above");
  }
  return kDone;
}

bool is_sweep(const std::string& file) {
  std::string line;
  std::getline(std::ifstream(file), line);
  return !line.empty() && sweep_header().starts_with(line);
}

/// Writes the tables and the numbers, and draws these.
int write_report(const ReportCommand& command, const std::string& tables,
                 const std::string& figures) {
  make_output_folder(command.folder, "--output-dir");
  const auto path = [&](const char* name) { return (fs::path(command.folder) / name).string(); };
  write_text_file(path("tables.md"), tables);
  write_text_file(path("figures.json"), figures);
  return draw_figures(command);
}

int report_sweep(const ReportCommand& command) {
  const std::string& file = command.results.front();
  const std::vector<SweepRow> rows = read_sweep(file);
  if (rows.empty()) throw InputError(file, "has no rows; let mvtp sweep run first");
  return write_report(command, sweep_to_markdown(rows), sweep_to_json(rows));
}

int report_bench(const ReportCommand& command) {
  const std::string& file = command.results.front();
  const std::vector<ResultRow> rows = read_results(file);
  if (rows.empty()) throw InputError(file, "has no rows; let mvtp bench run first");
  const std::vector<SuiteSummary> suites = summarise(rows, command.time_limit);
  return write_report(command, to_markdown(suites, command.time_limit),
                      to_json(suites, command.time_limit));
}

int report_runs(const ReportCommand& command) {
  const std::vector<ReportedRun> runs = read_runs(command.results);
  std::vector<SweepRow> rows;
  for (const ReportedRun& run : runs) rows.push_back(run.row);
  if (std::ranges::none_of(runs, [](const ReportedRun& run) { return run.replay.has_value(); })) {
    throw InputError(runs.front().page(),
                     "is missing, which the time-space diagram needs; run without --no-view");
  }
  return write_report(command, sweep_to_markdown(rows), runs_to_json(runs, command.time_space));
}

int report(const ReportCommand& command) {
  if (fs::is_directory(command.results.front())) return report_runs(command);
  if (command.results.size() > 1) {
    throw InputError(command.results[1],
                     "is one too many: give one table, or the folders of runs; tables are joined "
                     "by mvtp bench merge and mvtp sweep merge");
  }
  return is_sweep(command.results.front()) ? report_sweep(command) : report_bench(command);
}

}  // namespace

Action declare_report(CLI::App& app) {
  const auto command = std::make_shared<ReportCommand>();
  app.footer(
      "Of a table of mvtp bench: NAME.svg and NAME.png for each suite (\"results\" for instances "
      "of\n"
      "others), with a column for each map. Maps and numbers of robots are read from the names of\n"
      "the instances. Of one of mvtp sweep: delay over demand and over penetration, arrivals by "
      "the\n"
      "minute. Of the folders of runs of mvtp coordinate, or of mvtp compare: the time-space "
      "diagram\n"
      "of a movement, a panel for each run that has its replay; arrivals by the minute;\n"
      "distributions of post-encroachment times and times to collision. Always: tables.md, and\n"
      "figures.json, the numbers that were drawn.");
  app.add_option("RESULTS", command->results,
                 "What mvtp bench or mvtp sweep wrote (CSV), or folders of runs")
      ->required()
      ->type_name("FILE|DIR")
      ->group("Input");
  app.add_option(
         "--time-limit", command->time_limit,
         "Of a bench: run time of runs without success, as in the paper [s] [what they took]")
      ->type_name("S")
      ->check(positive_number)
      ->group("Input");
  app.add_option(
         "--movement", command->time_space.movement,
         "Of runs: first and last edge of the routes whose vehicles the time-space diagram\n"
         "shows, in quotes, as in vehicles.csv [that of most vehicles]")
      ->type_name("FROM>TO")
      ->group("Input");
  app.add_option("--begin", command->time_space.begin,
                 "Of runs: the time at which that diagram begins [s] [the begin of the first run]")
      ->type_name("S")
      ->check(number_between(0.0, 1e9))
      ->group("Input");
  app.add_option("--end", command->time_space.end, "The time at which it ends [s] [300 s later]")
      ->type_name("S")
      ->check(number_between(0.0, 1e9))
      ->group("Input");
  app.add_option("-o,--output-dir", command->folder, "Folder of the report; made if missing")
      ->required()
      ->type_name("DIR")
      ->group("Output");
  app.add_option("--python", command->python, "Python with matplotlib [/usr/bin/python3]")
      ->type_name("FILE")
      ->group("Output");
  return [command] { return report(*command); };
}

}  // namespace mvtp
