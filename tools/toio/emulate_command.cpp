#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "planner/problem/text_file.hpp"
#include "tools/cli/option_types.hpp"
#include "tools/cli/output_files.hpp"
#include "tools/cli/progress.hpp"
#include "tools/toio/commands.hpp"
#include "tools/toio/emulator/emulate.hpp"
#include "tools/toio/emulator/stalls.hpp"
#include "tools/toio/plan/check.hpp"

namespace mvtp {
namespace {

struct EmulateCommand {
  std::vector<std::string> runs;  ///< files
  EmulateOptions options;
  std::string stall = "0";
  double delay_ms = 130.0;
  double loss_percent = 0.0;
  int times = 1;
  bool no_gating = false;
  std::string report;
  bool quiet = false;
};

nlohmann::ordered_json json_of(const std::string& file, std::uint64_t seed, const ToioRun& run,
                               const EmulateReport& report) {
  nlohmann::ordered_json robots = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < report.robots.size(); ++i) {
    const RobotOutcome& robot = report.robots[i];
    nlohmann::ordered_json track = nlohmann::ordered_json::array();
    for (const Pose& pose : report.tracks[i]) {
      track.push_back({std::round(pose.x * 1e5) / 1e2, std::round(pose.y * 1e5) / 1e2,
                       std::round(pose.theta * 1e4) / 1e4});
    }
    robots.push_back({{"id", run.robots[i].id},
                      {"arrived", robot.arrived},
                      {"arrival_s", robot.arrival},
                      {"waited_s", robot.waited},
                      {"held_s", robot.held},
                      {"lateral_mm", in_mm(robot.most_lateral)},
                      {"along_mm", in_mm(robot.most_along)},
                      {"track_mm", track}});
  }
  return {{"run", file},
          {"seed", seed},
          {"finished", report.finished},
          {"duration_s", report.duration},
          {"clearance_least_mm", std::isfinite(report.least_clearance)
                                     ? nlohmann::ordered_json(in_mm(report.least_clearance))
                                     : nlohmann::ordered_json()},
          {"touching", report.touching},
          {"stalls", report.stalls},
          {"robots", robots}};
}

void print_report(const std::string& name, std::uint64_t seed, const EmulateReport& report) {
  fmt::print(
      "{}seed {}: {} in {:.1f} s, {} stalls, bodies {:.1f} mm apart at least, waited {:.1f} s, "
      "beside {:.1f} mm, along {:.1f} mm{}\n",
      name, seed, report.finished ? "finished" : "NOT FINISHED", report.duration, report.stalls,
      std::isfinite(report.least_clearance) ? in_mm(report.least_clearance) : 0.0, report.waited(),
      in_mm(report.most_lateral()), in_mm(report.most_along()),
      report.touching.empty() ? "" : "; TOUCHING: " + report.touching.front());
}

/// What many runs have in common.
class Summary {
 public:
  void add(const EmulateReport& report) {
    touching_ += report.touching.empty() ? 0 : 1;
    unfinished_ += report.finished ? 0 : 1;
    good_ += report.finished && report.touching.empty() ? 1 : 0;
    duration_ += report.duration;
    beside_.push_back(report.most_lateral());
  }

  [[nodiscard]] bool all_good() const { return good_ == beside_.size(); }

  /// @pre something was added.
  void print() {
    std::ranges::sort(beside_);
    const std::size_t n = beside_.size();
    fmt::print(
        "{} of {} runs finished untouched; {} touching, {} not finished; {:.2f} s in the mean; "
        "beside the path at most {:.1f} mm in 95 % of the runs, {:.1f} mm in all\n",
        good_, n, touching_, unfinished_, duration_ / double(n), in_mm(beside_[(n - 1) * 95 / 100]),
        in_mm(beside_.back()));
  }

 private:
  std::size_t good_ = 0;
  std::size_t touching_ = 0;
  std::size_t unfinished_ = 0;
  double duration_ = 0.0;       ///< of all together [s]
  std::vector<double> beside_;  ///< the most of each run [m]
};

int emulate_runs(EmulateCommand command) {
  const Stalls stalls = parse_stalls(command.stall);
  command.options.stalls_per_minute = stalls.per_minute;
  command.options.shortest_stall = stalls.shortest;
  command.options.longest_stall = stalls.longest;
  command.options.delay = command.options.player.lag = command.delay_ms / 1000.0;
  command.options.loss = command.loss_percent / 100.0;
  command.options.player.gating = !command.no_gating;
  check_output_files({command.report}, command.runs);
  std::vector<ToioRun> runs;
  for (const std::string& file : command.runs) {
    runs.push_back(read_drivable_run(file, command.options.player.mode));
  }

  Summary summary;
  Progress progress("emulate", command.quiet);
  const double times = double(runs.size()) * command.times;
  nlohmann::ordered_json reports = nlohmann::ordered_json::array();
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const std::string& file = command.runs[r];
    EmulateOptions options = command.options;
    for (int n = 0; n < command.times; ++n, ++options.seed) {
      const EmulateReport report = emulate(runs[r], options);
      summary.add(report);
      progress.update((double(r) * command.times + n + 1) / times);
      print_report(runs.size() == 1 ? "" : file + ": ", options.seed, report);
      if (!command.report.empty()) reports.push_back(json_of(file, options.seed, runs[r], report));
    }
  }
  if (runs.size() > 1 || command.times > 1) summary.print();
  if (!command.report.empty()) write_text_file(command.report, reports.dump(1) + "\n");
  return summary.all_good() ? kDone : kNotAchieved;
}

}  // namespace

ToioCommand declare_toio_emulate(CLI::App& toio) {
  CLI::App* app = toio.add_subcommand("emulate", "Drive a run on cubes emulated in the process");
  const auto command = std::make_shared<EmulateCommand>();
  app->footer("Exit code: 0 all arrived and none touched, 1 otherwise, 2 bad input.");
  app->add_option("RUN", command->runs, "Run files of mvtp toio export")
      ->required()
      ->type_name("FILE")
      ->group("Input");
  app->add_option("--delay", command->delay_ms,
                  "From a command to the report of what it did, +-30 % [ms] [130]")
      ->check(number_between(0, 1000))
      ->type_name("MS")
      ->group("World");
  app->add_option("--stall", command->stall,
                  "Blocked wheels: per cube and minute, and how long, e.g. 2:1-5 [none]")
      ->type_name("RATE:SECONDS")
      ->group("World");
  app->add_option("--loss", command->loss_percent, "Of commands and reports [%] [0]")
      ->check(number_between(0, 90))
      ->type_name("PERCENT")
      ->group("World");
  app->add_option("--seed", command->options.seed, "Of the world's chances [0]")
      ->check(whole_number_between(0, std::numeric_limits<std::int64_t>::max()))
      ->type_name("N")
      ->group("World");
  app->add_option("--runs", command->times, "Runs of each file, with seeds from --seed on [1]")
      ->check(whole_number_between(1, 1'000'000))
      ->type_name("N")
      ->group("World");
  add_choice<DriveMode>(*app, "--mode", command->options.player.mode,
                        {{"track", DriveMode::kTrack}, {"target", DriveMode::kTarget}},
                        "Wheel speeds, or targets one by one [track]")
      ->group("Player");
  app->add_flag("--no-gating", command->no_gating,
                "Drive by the clock alone: shows what the release graph is for")
      ->group("Player");
  app->add_option("--report", command->report, "Figures and true tracks to write (JSON) [none]")
      ->type_name("FILE")
      ->group("Output");
  app->add_flag("-q,--quiet", command->quiet, "No progress on stderr")->group("Output");
  return {app, [command] { return emulate_runs(*command); }};
}

}  // namespace mvtp
