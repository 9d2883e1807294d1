#include "tools/report/run_folders.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "tools/view/page.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxPageBytes = 2'000'000'000;
constexpr std::size_t kMaxSummaryBytes = 1'000'000;

bool is_run(const fs::path& folder) { return fs::exists(folder / "summary.json"); }

/// A run, or the runs of a comparison in the order of their names.
std::vector<std::string> run_folders_in(const std::string& folder) {
  if (!fs::is_directory(folder)) {
    throw InputError(folder, "is neither a table (CSV) nor the folder of a run");
  }
  if (is_run(folder)) return {folder};
  std::vector<std::string> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory() && is_run(entry.path())) found.push_back(entry.path().string());
  }
  if (found.empty()) {
    throw InputError(folder,
                     "holds no summary.json; give the folder of a run of mvtp coordinate, or that "
                     "of mvtp compare");
  }
  std::ranges::sort(found);
  return found;
}

/// The name of the control, as mvtp compare names its folders: CONTROL-SEED.
std::string control_of(const std::string& folder, const SweepRow& row) {
  const std::string name = fs::canonical(folder).filename().string();
  const std::string seed = fmt::format("-{}", row.seed);
  const bool compared = name.ends_with(seed) && fs::exists(fs::path(folder) / "messages.txt");
  return compared ? name.substr(0, name.size() - seed.size()) : row.controller;
}

void read_identity(const std::string& text, const std::string& where, ReportedRun& run) {
  SweepRow& row = run.row;
  try {
    const auto summary = nlohmann::json::parse(text);
    run.post_encroachment = summary.at("pet_s").value("by_half_second", std::vector<double>());
    run.to_collision = summary.at("ttc_s").value("by_half_second", std::vector<double>());
    row.controller = summary.at("controller").get<std::string>();
    row.penetration = summary.at("penetration").get<double>();
    row.seed = summary.at("seed").get<std::uint64_t>();
    row.version = summary.at("mvtp_version").get<std::string>();
  } catch (const nlohmann::json::exception&) {
    throw InputError(where, "is no summary of a run; run mvtp coordinate again");
  }
}

ReportedRun read_run(const std::string& folder) {
  ReportedRun run;
  run.folder = folder;
  const std::string summary = (fs::path(folder) / "summary.json").string();
  const std::string text = read_text_file(summary, kMaxSummaryBytes);
  read_identity(text, summary, run);
  read_sweep_figures(text, summary, run.row);
  run.label = control_of(folder, run.row);
  if (fs::exists(run.page())) {
    run.replay = replays_of(read_text_file(run.page(), kMaxPageBytes), run.page()).front();
    run.row.scenario = fs::path(run.replay->title).filename().string();
  }
  return run;
}

}  // namespace

std::vector<ReportedRun> read_runs(const std::vector<std::string>& folders) {
  std::vector<ReportedRun> runs;
  for (const std::string& folder : folders) {
    for (const std::string& one : run_folders_in(folder)) runs.push_back(read_run(one));
  }
  // The same control and seed twice: something else makes the difference.
  std::set<std::pair<std::string, std::uint64_t>> keys;
  bool distinct = true;
  for (const ReportedRun& run : runs) {
    distinct = keys.emplace(run.label, run.row.seed).second && distinct;
  }
  std::map<std::string, std::string> scenarios;
  for (ReportedRun& run : runs) {
    if (!distinct) run.label = run.folder;
    run.row.controller = run.label;
    if (run.replay) scenarios[run.label] = run.row.scenario;
  }
  // The page tells the scenario; runs of one control have the same.
  for (ReportedRun& run : runs) {
    const auto known = scenarios.find(run.label);
    run.row.scenario = known == scenarios.end() ? "–" : known->second;
  }
  return runs;
}

}  // namespace mvtp
