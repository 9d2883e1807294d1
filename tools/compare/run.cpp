#include "tools/compare/run.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>

#include "coordinator/controllers/registry.hpp"
#include "coordinator/simulation/simulation.hpp"
#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "tools/cli/child_process.hpp"
#include "tools/cli/command_line.hpp"
#include "tools/cli/output_folder.hpp"
#include "tools/cli/program.hpp"
#include "tools/cli/progress.hpp"
#include "tools/cli/run_folder.hpp"
#include "tools/cli/version.hpp"
#include "tools/compare/controls.hpp"
#include "tools/runs/comparison.hpp"
#include "tools/view/load.hpp"
#include "tools/view/page.hpp"
#include "traci_bridge/configuration.hpp"
#include "traci_bridge/network.hpp"
#include "traci_bridge/parking_file.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCoordinated = "coordinated";
constexpr std::string_view kNote = "mvtp: note: ";
constexpr std::size_t kMaxSummaryBytes = 1'000'000;

/// What the junctions of a scenario have by themselves: "own light", or SUMO's word for the rule,
/// e.g. "priority".
std::string own_control(const CompareOptions& options) {
  const RoadNetwork network = read_network(read_configuration(options.run.configuration).net_file);
  const std::vector<std::string>& chosen = options.run.junctions;
  std::set<std::string> types;
  for (const auto& [id, junction] : network.junctions) {
    const bool ours =
        chosen.empty() ? junction.has_conflicts : std::ranges::find(chosen, id) != chosen.end();
    if (ours) types.insert(junction.type);
  }
  if (std::ranges::any_of(types, [](const auto& t) { return t.starts_with("traffic_light"); })) {
    return "own light";
  }
  return types.size() == 1 ? *types.begin() : "own rules";
}

bool has_parking_lot(const CompareOptions& options) {
  const SumoConfiguration configuration = read_configuration(options.run.configuration);
  const RoadNetwork network = read_network(configuration.net_file);
  return !read_parking_lots(configuration.additional_files, network).empty();
}

/// Those that are named; else the twins that lie beside the scenario, the scenario's own control,
/// and coordinated; on a parking lot, where SUMO's drivers know no manoeuvres, simpler planners and
/// ESCoT.
std::vector<Control> controls_of(const CompareOptions& options) {
  if (!options.controllers.empty())
    return named_controls(options.run.configuration, options.controllers);
  const std::string& scenario = options.run.configuration;
  if (has_parking_lot(options)) {
    const auto by = [&](LotController simpler) -> Control {
      const ControllerKind& kind = controller_of_lots(simpler);
      return {kind.name, scenario, kind.name, kind.drives};
    };
    return {by(LotController::kOneAtATime),
            by(LotController::kPrioritized),
            {kCoordinated, scenario, kUsualController, true}};
  }
  const std::string own = own_control(options);
  std::vector<Control> controls;
  for (const char* kind : {"static", "actuated"}) {
    if (const auto twin = twin_of(scenario, kind))
      controls.push_back({kind, *twin, kSumosController});
  }
  controls.push_back({own, options.run.configuration, kSumosController});
  controls.push_back({kCoordinated, options.run.configuration, kUsualController, true});
  return controls;
}

std::string first_line(const fs::path& file) {
  std::ifstream stream(file);
  constexpr std::string_view kName = "mvtp: ";
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with(kName) && !line.starts_with(kNote)) {
      return line.substr(kName.size());
    }
  }
  return "";
}

class Comparison {
 public:
  explicit Comparison(const CompareOptions& options)
      : options_(options), controls_(controls_of(options)), directory_(options.output_dir) {
    for (const std::uint32_t seed : options.seeds) {
      for (const Control& control : controls_) plan(control, seed);
    }
    prepare_folders();
  }

  int run() {
    const bool complete = run_all();
    if (!refusal_.empty()) {
      fmt::print(stderr, "mvtp: {}\n", refusal_);
      return kBadInput;
    }
    pass_on_notes();
    sort_by_control();
    write_text_file(path("compare.csv"), comparison_csv(runs_));
    write_text_file(path("compare.json"),
                    comparison_json(runs_, options_.run.configuration, version(), command_line()));
    fmt::print("{}", comparison_table(runs_));
    if (write_page()) fmt::print("replay: {}\n", path("view.html"));
    if (!complete) return kInterrupted;
    return std::ranges::all_of(runs_, [](const auto& r) { return succeeded(r); }) ? kDone
                                                                                  : complain();
  }

 private:
  /// What the first run of the last control has to say about the scenario; all say the same.
  void pass_on_notes() const {
    const auto run = std::ranges::find(runs_, controls_.back().name, &ComparedRun::control);
    std::ifstream messages(jobs_[std::size_t(run - runs_.begin())].messages);
    for (std::string line; std::getline(messages, line);) {
      if (line.starts_with(kNote)) fmt::print(stderr, "{}\n", line);
    }
  }

  void plan(const Control& control, std::uint32_t seed) {
    ComparedRun run;
    run.control = control.name;
    run.drives = control.drives;
    run.seed = seed;
    std::string name = fmt::format("{}-{}", control.name, seed);
    std::ranges::replace(name, ' ', '-');
    run.folder = path(name.c_str());

    Job job;
    job.arguments = {fs::read_symlink("/proc/self/exe").string(),
                     "coordinate",
                     "--configuration=" + control.configuration,
                     "--controller=" + control.controller,
                     fmt::format("--seed={}", seed),
                     "--output-dir=" + run.folder,
                     "--quiet"};
    if (!options_.keep_fcd) job.arguments.push_back("--no-fcd");
    if (!is_replayed(control, seed)) job.arguments.push_back("--no-view");
    job.arguments.insert(job.arguments.end(), options_.run_arguments.begin(),
                         options_.run_arguments.end());
    job.messages = fs::path(run.folder) / "messages.txt";
    runs_.push_back(std::move(run));
    jobs_.push_back(std::move(job));
  }

  /// The page shows the first seed under a control of SUMO (one with a light, or
  /// else the last), and under the last that is; none if there are not both.
  [[nodiscard]] bool is_replayed(const Control& control, std::uint32_t seed) const {
    return seed == options_.seeds.front() &&
           std::ranges::count(replayed(), control.name, &Control::name) > 0;
  }

  [[nodiscard]] std::vector<Control> replayed() const {
    std::vector<Control> ours, rivals;
    for (const Control& c : controls_) (c.drives ? ours : rivals).push_back(c);
    if (ours.empty()) return {};
    if (rivals.empty() && ours.size() > 1) rivals = {ours.end()[-2]};  // on a parking lot
    if (rivals.empty()) return {};
    for (const char* name : {"actuated", "static"}) {
      const auto found = std::ranges::find(rivals, name, &Control::name);
      if (found != rivals.end()) return {*found, ours.back()};
    }
    return {rivals.back(), ours.back()};
  }

  /// Makes a folder for each run, without the results of an earlier one: a run that fails must not
  /// pass off another's as its own.
  void prepare_folders() const {
    make_output_folder(options_.output_dir, "--output-dir");
    require_room(options_.output_dir, "--output-dir");
    for (const ComparedRun& run : runs_) {
      std::error_code error;
      fs::create_directories(run.folder, error);
      if (error) {
        throw InputError(run.folder, "cannot make this folder (" + error.message() +
                                         "); choose another --output-dir");
      }
      for (const char* name : {"summary.json", "view.html", "fcd.xml", "messages.txt"}) {
        const std::string file = (fs::path(run.folder) / name).string();
        check_writable(file);
        fs::remove(file, error);
      }
    }
    for (const char* name : {"compare.csv", "compare.json", "view.html"}) {
      check_writable(path(name));
    }
  }

  /// Returns whether no signal cut it short.
  bool run_all() {
    Progress progress("compare", options_.quiet);
    std::size_t done = 0;
    return run_jobs(jobs_, options_.jobs, [&](std::size_t i, int status) {
      judge(i, status);
      ++done;
      progress.update(double(done) / double(runs_.size()),
                      fmt::format("{} seed {}", runs_[i].control, runs_[i].seed));
      return refusal_.empty();
    });
  }

  /// Reads what a run that ended has left.
  void judge(std::size_t i, int status) {
    ComparedRun& run = runs_[i];
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : kNotAchieved;
    if (code == kBadInput && refusal_.empty()) refusal_ = reason_of(i);
    if (WIFSIGNALED(status)) {
      const std::string said = first_line(jobs_[i].messages);
      run.failure = fmt::format("crashed ({}){}{}", strsignal(WTERMSIG(status)),
                                said.empty() ? "" : ": ", said);
      (void)complete_crashed_run(run.folder, run.failure);
      return;
    }
    if (code == kInterrupted) {
      run.failure = "interrupted";
      return;
    }
    const std::string summary = (fs::path(run.folder) / "summary.json").string();
    try {
      read_summary(read_text_file(summary, kMaxSummaryBytes), summary, run);
      if (run.status == to_string(RunStatus::kFailed)) {
        run.failure = first_line(jobs_[i].messages);  // its figures end where it failed
      }
    } catch (const InputError& error) {
      const std::string said = first_line(jobs_[i].messages);
      run.failure = fmt::format("exit code {}: {}", code, said.empty() ? error.what() : said);
    }
  }

  /// Why a run refuses its input. Each says why, if there is room for it.
  [[nodiscard]] std::string reason_of(std::size_t i) const {
    const std::string said = first_line(jobs_[i].messages);
    if (!said.empty()) return said;
    return runs_[i].folder + ": the disk is full; make room or choose another --output-dir";
  }

  void sort_by_control() {
    const auto rank = [&](const ComparedRun& run) {
      return std::ranges::find(controls_, run.control, &Control::name) - controls_.begin();
    };
    std::ranges::stable_sort(runs_, {}, rank);
  }

  /// Returns whether there is something to show.
  [[nodiscard]] bool write_page() const {
    ViewRequest request;
    for (const Control& control : replayed()) {
      const auto run = std::ranges::find_if(runs_, [&](const ComparedRun& r) {
        return r.control == control.name && r.seed == options_.seeds.front() && r.failure.empty();
      });
      if (run == runs_.end()) return false;
      request.files.push_back((fs::path(run->folder) / "view.html").string());
      request.labels.push_back(control.name);
    }
    if (request.files.empty()) return false;
    write_text_file(path("view.html"), to_html(load_replays(request)));
    return true;
  }

  [[nodiscard]] int complain() const {
    for (const ComparedRun& run : runs_) {
      if (succeeded(run)) continue;
      fmt::print(stderr, "mvtp: {}, seed {}: {}\n", run.control, run.seed,
                 !run.failure.empty() ? run.failure
                 : run.status == "stuck"
                     ? "traffic got stuck"
                     : fmt::format("coordinated vehicles overlapped; see {}", run.folder));
    }
    return kNotAchieved;
  }

  [[nodiscard]] std::string path(const char* name) const { return (directory_ / name).string(); }

  const CompareOptions& options_;
  std::vector<Control> controls_;
  fs::path directory_;
  std::vector<ComparedRun> runs_;
  std::vector<Job> jobs_;
  std::string refusal_;  ///< what a run had against the input
};

}  // namespace

int run_compare(const CompareOptions& options) {
  ::unsetenv(kRunFolderNote);  // each run has a folder of its own
  return Comparison(options).run();
}

}  // namespace mvtp
