#include "tools/bench/bench.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <deque>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "planner/problem/input_error.hpp"
#include "planner/problem/plan_file.hpp"
#include "tools/bench/instance_paths.hpp"
#include "tools/bench/results.hpp"
#include "tools/cli/child_process.hpp"
#include "tools/cli/output_folder.hpp"
#include "tools/cli/program.hpp"
#include "tools/cli/progress.hpp"
#include "tools/cli/version.hpp"
#include "tools/runs/same_options.hpp"
#include "tools/runs/temporary_folder.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

// A solver that keeps its time limit never meets these; one that hangs must not stop the rest.
constexpr double kTimeLimitFactor = 1.5;  // times the time limit
constexpr double kLoading = 30.0;         // [s]
constexpr double kRefereeLimit = 1000.0;  // [s]

/// One row to be measured.
struct Run {
  InstancePath instance;
  std::string algorithm;
  std::uint32_t seed = 0;
};

std::vector<Run> runs_of(const BenchOptions& options, const std::vector<InstancePath>& instances,
                         const std::set<RunKey>& done) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < instances.size(); ++i) {
    if (!options.shard.has(i)) continue;
    for (const std::string& algorithm : options.algorithms) {
      for (const std::uint32_t seed : options.seeds) {
        if (done.contains({instances[i].name, algorithm, seed})) continue;
        runs.push_back({instances[i], algorithm, seed});
      }
    }
  }
  return runs;
}

std::string first_line(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  constexpr std::string_view kName = "mvtp: ";
  return line.starts_with(kName) ? line.substr(kName.size()) : line;
}

/// Each run is two jobs: `solve`, and if it wrote a plan `validate`.
class Bench : public JobSource {
 public:
  Bench(const BenchOptions& options, const TemporaryFolder& scratch, std::vector<Run> runs,
        ResultFile& results)
      : options_(options), scratch_(scratch), results_(results), runs_(std::move(runs)) {}

  int run() {
    progress_.emplace("bench", options_.quiet);
    const bool complete = run_jobs(*this, options_.jobs);
    progress_.reset();  // ends its line
    report();
    return complete ? kDone : kInterrupted;
  }

  [[nodiscard]] std::optional<Job> next() override {
    if (!to_judge_.empty()) {
      const std::size_t i = to_judge_.front();
      to_judge_.pop_front();
      return judging(i);
    }
    if (next_ == runs_.size()) return std::nullopt;
    return solving(next_++);
  }

  [[nodiscard]] bool finished(const Job& job, const JobEnd& end) override {
    if (end.interrupted) return false;
    const std::size_t i = job.tag / 2;
    if (job.tag % 2 == 0) {
      ResultRow row = result_of(i, end);
      if (row.status == "solved") {
        solved_.emplace(i, std::move(row));
        to_judge_.push_back(i);
        return true;
      }
      finish(i, row);
    } else {
      ResultRow row = std::move(solved_.extract(i).mapped());
      row.valid = WIFEXITED(end.status) && WEXITSTATUS(end.status) == kDone;
      if (!row.valid) complain(i, "the referee rejects the plan");
      finish(i, row);
    }
    return true;
  }

 private:
  [[nodiscard]] fs::path scratch(std::size_t i, const char* kind) const {
    return scratch_.path() / fmt::format("{}.{}", i, kind);
  }

  /// A plan has to be written, or it could not be refereed from its file.
  [[nodiscard]] fs::path plan_file(std::size_t i) const {
    if (options_.plans.empty()) return scratch(i, "plan.yaml");
    const Run& run = runs_[i];
    const fs::path name = fs::path(run.instance.name).replace_extension();
    return fs::path(options_.plans) /
           fmt::format("{}.{}.seed{}.yaml", name.string(), run.algorithm, run.seed);
  }

  Job solving(std::size_t i) const {
    const Run& run = runs_[i];
    std::error_code ignored;
    fs::create_directories(plan_file(i).parent_path(), ignored);  // solve will say what is wrong
    fs::remove(plan_file(i), ignored);  // or an old plan could pass for that of this run
    Job job;
    job.arguments = {program_,
                     "solve",
                     "--instance=" + run.instance.file,
                     "--output=" + plan_file(i).string(),
                     "--statistics=" + scratch(i, "statistics").string(),
                     "--algorithm=" + run.algorithm,
                     fmt::format("--seed={}", run.seed),
                     "--quiet"};
    job.arguments.insert(job.arguments.end(), options_.solve_words.begin(),
                         options_.solve_words.end());
    job.messages = scratch(i, "messages");
    job.time_limit = kTimeLimitFactor * options_.time_limit + kLoading;
    job.tag = 2 * i;
    return job;
  }

  Job judging(std::size_t i) const {
    Job job;
    job.arguments = {program_, "validate", "--instance=" + runs_[i].instance.file,
                     "--plan=" + plan_file(i).string(), "--quiet"};
    job.arguments.insert(job.arguments.end(), options_.validate_words.begin(),
                         options_.validate_words.end());
    job.messages = scratch(i, "verdict");
    job.time_limit = kRefereeLimit;
    job.tag = 2 * i + 1;
    return job;
  }

  /// What the solver left behind, or that it left nothing.
  ResultRow result_of(std::size_t i, const JobEnd& end) {
    ResultRow row;
    row.instance = runs_[i].instance.name;
    row.algorithm = runs_[i].algorithm;
    row.seed = runs_[i].seed;
    row.runtime = end.seconds;
    row.peak_rss = end.peak_rss;
    row.version = version();
    if (const std::optional<Statistics> told = statistics_of(i, end)) {
      fill_in(i, *told, row);
    } else {
      fill_in_failure(i, end, row);
    }
    return row;
  }

  /// None if the solver did not get as far, or its plan could not be written.
  [[nodiscard]] std::optional<Statistics> statistics_of(std::size_t i, const JobEnd& end) const {
    const std::string file = scratch(i, "statistics").string();
    if (end.out_of_time || !WIFEXITED(end.status) || !fs::exists(file)) return std::nullopt;
    Statistics told = read_plan(file).statistics;
    if (told.status == "solved" && !fs::exists(plan_file(i))) return std::nullopt;
    return told;
  }

  void fill_in(std::size_t i, const Statistics& statistics, ResultRow& row) {
    row.status = statistics.status;
    if (statistics.lower_bound > 0.0) row.lower_bound = statistics.lower_bound;
    if (statistics.runtime > 0.0) row.runtime = statistics.runtime;
    if (row.status == "invalid" || row.status == "infeasible") complain(i, statistics.reason);
    if (!statistics.initial_overlaps.empty()) ++with_overlaps_;
    if (row.status != "solved") return;
    const double dt = read_instance(runs_[i].instance.file, options_.reading).dt;
    row.solved_seed = statistics.seed;
    row.makespan = statistics.makespan;
    row.makespan_steps = std::uint64_t(std::ceil(statistics.makespan / dt - 1e-9));
    row.flowtime = statistics.flowtime;
    row.first_solution = statistics.first_solution.value_or(statistics.runtime);
  }

  void fill_in_failure(std::size_t i, const JobEnd& end, ResultRow& row) {
    const std::string said = first_line(scratch(i, "messages"));
    if (WIFEXITED(end.status)) scratch_.rule_out_full_disk(said);
    row.status = end.out_of_time                                                 ? "killed"
                 : WIFEXITED(end.status) && WEXITSTATUS(end.status) == kBadInput ? "refused"
                                                                                 : "crashed";
    complain(i, end.out_of_time ? fmt::format("did not end after {:.0f} s", end.seconds)
                : WIFSIGNALED(end.status)
                    ? fmt::format("{} {}", strsignal(WTERMSIG(end.status)), said)
                    : said);
  }

  void finish(std::size_t i, const ResultRow& row) {
    results_.append(row);
    ++ends_[row.status];
    if (row.valid) ++valid_;
    std::error_code ignored;
    for (const char* kind : {"statistics", "messages", "verdict", "plan.yaml"}) {
      fs::remove(scratch(i, kind), ignored);
    }
    ++finished_;
    progress_->update(double(finished_) / double(runs_.size()),
                      fmt::format("{} {}", row.instance, row.algorithm));
  }

  void complain(std::size_t i, const std::string& what) {
    const Run& run = runs_[i];
    complaints_.push_back(
        fmt::format("{}, {}, seed {}: {}", run.instance.name, run.algorithm, run.seed, what));
  }

  /// What happened, in a few lines on stderr.
  void report() const {
    constexpr std::size_t kMost = 10;
    for (std::size_t i = 0; i < std::min(kMost, complaints_.size()); ++i) {
      fmt::print(stderr, "mvtp: {}\n", complaints_[i]);
    }
    if (complaints_.size() > kMost) {
      fmt::print(stderr, "mvtp: and {} more like these\n", complaints_.size() - kMost);
    }
    if (options_.quiet) return;
    if (runs_.empty()) {
      fmt::print(stderr, "bench: nothing to do: {} has all these runs\n", options_.output);
      return;
    }
    std::string ends;
    for (const auto& [status, count] : ends_) ends += fmt::format("{} {}, ", count, status);
    fmt::print(
        stderr, "bench: {} of {} runs: {}{} valid{}\n", finished_, runs_.size(), ends, valid_,
        with_overlaps_ == 0 ? std::string()
                            : fmt::format("; in {} an initial overlap is allowed", with_overlaps_));
  }

  const BenchOptions& options_;
  const TemporaryFolder& scratch_;
  ResultFile& results_;
  std::vector<Run> runs_;
  std::string program_ = fs::read_symlink("/proc/self/exe").string();
  std::optional<Progress> progress_;  ///< while jobs run
  std::size_t next_ = 0;
  std::deque<std::size_t> to_judge_;
  std::map<std::size_t, ResultRow> solved_;  ///< not yet judged
  std::size_t finished_ = 0;
  std::size_t valid_ = 0;
  std::size_t with_overlaps_ = 0;    ///< runs on instances with an initial overlap that is allowed
  std::map<std::string, int> ends_;  ///< how many runs ended with each status
  std::vector<std::string> complaints_;
};

}  // namespace

int run_bench(const BenchOptions& options) {
  const std::vector<InstancePath> instances = find_instances(options.paths);
  if (!options.plans.empty()) make_output_folder(options.plans, "--plans");
  const TemporaryFolder scratch;  // before any file
  ResultFile results(options.output,
                     options.resume ? ResultFile::Mode::kResume : ResultFile::Mode::kCreate);
  require_same_options(options.output, options.solve_words, options.resume);
  return Bench(options, scratch, runs_of(options, instances, results.done()), results).run();
}

}  // namespace mvtp
