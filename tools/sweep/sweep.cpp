#include "tools/sweep/sweep.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <string_view>

#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "tools/cli/child_process.hpp"
#include "tools/cli/program.hpp"
#include "tools/cli/progress.hpp"
#include "tools/cli/run_folder.hpp"
#include "tools/cli/version.hpp"
#include "tools/compare/controls.hpp"
#include "tools/runs/same_options.hpp"
#include "tools/runs/temporary_folder.hpp"
#include "tools/sweep/rows.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxSummaryBytes = 10'000'000;

/// One row to be measured.
struct Run {
  Control control;
  SweepRow row;  ///< what identifies it
};

/// Every combination; a controller that drives nobody runs once for all penetrations.
std::vector<Run> all_runs(const SweepOptions& options) {
  std::vector<Run> runs;
  for (const double scale : options.scales) {
    for (const Control& control : named_controls(options.run.configuration, options.controllers)) {
      for (const double share : control.drives ? options.penetrations : std::vector<double>{0.0}) {
        for (const std::uint32_t seed : options.seeds) {
          runs.push_back({control,
                          {.scenario = fs::path(options.run.configuration).filename().string(),
                           .controller = control.name,
                           .scale = scale,
                           .penetration = share,
                           .seed = seed,
                           .status = "",
                           .version = version()}});
        }
      }
    }
  }
  return runs;
}

std::vector<Run> runs_to_do(const SweepOptions& options, const std::set<SweepKey>& done) {
  std::vector<Run> all = all_runs(options);
  std::vector<Run> runs;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!options.shard.has(i) || done.contains(key_of(all[i].row))) continue;
    runs.push_back(std::move(all[i]));
  }
  return runs;
}

class Sweep : public JobSource {
 public:
  Sweep(const SweepOptions& options, const TemporaryFolder& scratch, std::vector<Run> runs,
        SweepFile& results)
      : options_(options), scratch_(scratch), results_(results), runs_(std::move(runs)) {}

  int run() {
    progress_.emplace("sweep", options_.quiet);
    const bool complete = run_jobs(*this, options_.jobs);
    progress_.reset();  // ends its line
    for (const std::string& complaint : complaints_) fmt::print(stderr, "mvtp: {}\n", complaint);
    if (!options_.quiet) {
      fmt::print(stderr, "sweep: {} of {} runs done\n", finished_, runs_.size());
    }
    if (!complete) return kInterrupted;
    return complaints_.empty() ? kDone : kNotAchieved;
  }

  [[nodiscard]] std::optional<Job> next() override {
    if (next_ == runs_.size()) return std::nullopt;
    return job_for(next_++);
  }

  [[nodiscard]] bool finished(const Job& job, const JobEnd& end) override {
    if (end.interrupted) return false;
    SweepRow row = runs_[job.tag].row;
    row.runtime = end.seconds;
    row.peak_rss = end.peak_rss;
    judge(job, end, row);
    results_.append(row);
    std::error_code ignored;
    fs::remove_all(folder(job.tag), ignored);
    ++finished_;
    progress_->update(double(finished_) / double(runs_.size()),
                      fmt::format("{} x {}", row.controller, row.scale));
    return true;
  }

 private:
  [[nodiscard]] fs::path folder(std::size_t i) const {
    return scratch_.path() / fmt::format("{}", i);
  }

  [[nodiscard]] Job job_for(std::size_t i) const {
    const Run& run = runs_[i];
    Job job;
    job.arguments = {program_,
                     "coordinate",
                     "--configuration=" + run.control.configuration,
                     "--controller=" + run.control.controller,
                     fmt::format("--seed={}", run.row.seed),
                     "--output-dir=" + folder(i).string(),
                     "--quiet",
                     "--no-fcd",
                     "--no-view"};
    if (run.control.drives) {
      job.arguments.push_back(fmt::format("--penetration={}", run.row.penetration));
    }
    job.arguments.insert(job.arguments.end(), options_.run_arguments.begin(),
                         options_.run_arguments.end());
    if (run.row.scale != 1.0) {
      job.arguments.insert(job.arguments.end(), {"--scale", fmt::format("{}", run.row.scale)});
    }
    job.messages = scratch_.path() / fmt::format("{}.messages", i);
    job.tag = i;
    return job;
  }

  /// What the run left behind, or that it left nothing.
  void judge(const Job& job, const JobEnd& end, SweepRow& row) {
    const std::string summary = (folder(job.tag) / "summary.json").string();
    const bool exited = WIFEXITED(end.status);
    if (exited && WEXITSTATUS(end.status) != kBadInput && fs::exists(summary)) {
      read_sweep_figures(read_text_file(summary, kMaxSummaryBytes), summary, row);
      if (row.status != "failed") return;
    } else {
      row.status = exited && WEXITSTATUS(end.status) == kBadInput ? "refused" : "crashed";
    }
    const std::string said = exited ? what_it_said(job) : strsignal(WTERMSIG(end.status));
    if (exited) scratch_.rule_out_full_disk(said);
    complaints_.push_back(fmt::format("{} x {}, penetration {}, seed {}: {}: {}", row.controller,
                                      row.scale, row.penetration, row.seed, row.status, said));
  }

  [[nodiscard]] static std::string what_it_said(const Job& job) {
    std::ifstream stream(job.messages);
    constexpr std::string_view kName = "mvtp: ";
    for (std::string line; std::getline(stream, line);) {
      if (line.starts_with(kName) && !line.starts_with("mvtp: note: ")) {
        return line.substr(kName.size());
      }
    }
    return "";
  }

  const SweepOptions& options_;
  const TemporaryFolder& scratch_;
  SweepFile& results_;
  std::vector<Run> runs_;
  std::string program_ = fs::read_symlink("/proc/self/exe").string();
  std::optional<Progress> progress_;  ///< while jobs run
  std::size_t next_ = 0;
  std::size_t finished_ = 0;
  std::vector<std::string> complaints_;
};

/// What the rows of one table share; of the scenario, whose folder may move, the last two names.
std::vector<std::string> shared_options(const SweepOptions& options) {
  const fs::path scenario = fs::weakly_canonical(options.run.configuration);
  const fs::path named = scenario.parent_path().filename() / scenario.filename();
  std::vector<std::string> shared = {"--configuration=" + named.string()};
  shared.insert(shared.end(), options.run_arguments.begin(), options.run_arguments.end());
  return shared;
}

}  // namespace

int run_sweep(const SweepOptions& options) {
  ::unsetenv(kRunFolderNote);  // each run has a folder of its own
  (void)named_controls(options.run.configuration, options.controllers);  // before any file
  const TemporaryFolder scratch;
  SweepFile results(options.output,
                    options.resume ? RowFile::Mode::kResume : RowFile::Mode::kCreate);
  require_same_options(options.output, shared_options(options), options.resume);
  return Sweep(options, scratch, runs_to_do(options, results.done()), results).run();
}

}  // namespace mvtp
