#include <fmt/format.h>
#include <sys/wait.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "tools/bench/results.hpp"
#include "tools/child_process.hpp"
#include "tools/commands.hpp"
#include "tools/option_types.hpp"
#include "tools/output_folder.hpp"
#include "tools/report/summary.hpp"
#include "tools/report/sweep_figures.hpp"
#include "tools/sibling.hpp"
#include "tools/sweep/rows.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

struct ReportCommand {
  std::string results;
  std::string folder;
  std::optional<double> time_limit;
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

int report_sweep(const ReportCommand& command) {
  const std::vector<SweepRow> rows = read_sweep(command.results);
  if (rows.empty()) throw InputError(command.results, "has no rows; let mvtp sweep run first");
  make_output_folder(command.folder, "--output-dir");
  const auto path = [&](const char* name) { return (fs::path(command.folder) / name).string(); };
  write_text_file(path("tables.md"), sweep_to_markdown(rows));
  write_text_file(path("figures.json"), sweep_to_json(rows));
  return draw_figures(command);
}

int report(const ReportCommand& command) {
  if (is_sweep(command.results)) return report_sweep(command);
  const std::vector<ResultRow> rows = read_results(command.results);
  if (rows.empty()) throw InputError(command.results, "has no rows; let mvtp bench run first");
  make_output_folder(command.folder, "--output-dir");

  const std::vector<SuiteSummary> suites = summarise(rows, command.time_limit);
  const auto path = [&](const char* name) { return (fs::path(command.folder) / name).string(); };
  write_text_file(path("tables.md"), to_markdown(suites, command.time_limit));
  write_text_file(path("figures.json"), to_json(suites, command.time_limit));
  return draw_figures(command);
}

}  // namespace

Action declare_report(CLI::App& app) {
  const auto command = std::make_shared<ReportCommand>();
  app.footer(
      "Writes NAME.svg and NAME.png for each suite (\"results\" for instances of others), with a\n"
      "column for each map; tables.md; and figures.json, the numbers that were drawn. Maps and\n"
      "numbers of robots are read from the names of the instances. Of a sweep: delay over demand "
      "and\n"
      "over penetration, arrivals by the minute.");
  app.add_option("RESULTS", command->results, "What mvtp bench or mvtp sweep wrote (CSV)")
      ->required()
      ->type_name("FILE")
      ->group("Input");
  app.add_option("--time-limit", command->time_limit,
                 "Run time of runs without success, as in the paper [s] [what they took]")
      ->type_name("S")
      ->check(positive_number)
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
