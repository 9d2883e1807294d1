#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

#include "tools/report/summary.hpp"

namespace mvtp {
namespace {

using Json = nlohmann::ordered_json;

// ---- Markdown

/// A name is not to end the cell it stands in.
std::string cell_text(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '|' ? std::string("\\|") : std::string(1, c);
  return result;
}

std::string with_deviation(const std::optional<MeanAndDeviation>& value, int digits) {
  if (!value) return "–";
  return fmt::format("{:.{}f} ± {:.{}f}", value->mean, digits, value->deviation.value_or(0.0),
                     digits);
}

/// Three digits that say something.
std::string seconds(const std::optional<MeanAndDeviation>& value) {
  if (!value) return "–";
  const int digits = value->mean < 1.0 ? 3 : value->mean < 10.0 ? 2 : 1;
  return fmt::format("{:.{}f}", value->mean, digits);
}

std::string success(const CellSummary& cell) {
  std::string text = fmt::format("{:.0f} %", 100.0 * cell.valid / cell.runs);
  if (cell.solved != cell.valid) text += fmt::format(" (solver: {} of {})", cell.solved, cell.runs);
  return text;
}

void append_map(std::string& text, const MapSummary& map) {
  fmt::format_to(
      std::back_inserter(text),
      "\n### {}\n\n"
      "| robots | algorithm | runs | valid | makespan [steps] | makespan / bound | first "
      "solution [s] | runtime [s] | peak memory [MiB] |\n"
      "|---:|---|---:|---:|---:|---:|---:|---:|---:|\n",
      cell_text(map.map));
  for (const CellSummary& cell : map.cells) {
    fmt::format_to(std::back_inserter(text), "| {} | {} | {} | {} | {} | {} | {} | {} | {:.0f} |\n",
                   cell.robots ? fmt::to_string(*cell.robots) : "–", cell_text(cell.algorithm),
                   cell.runs, success(cell), with_deviation(cell.makespan_steps, 1),
                   with_deviation(cell.ratio, 3), seconds(cell.first_solution),
                   seconds(cell.runtime), cell.peak_rss);
  }
}

std::string comparison_text(const SuiteSummary& suite, const std::string& a, const std::string& b) {
  for (const Comparison& c : suite.comparisons) {
    if (c.algorithm == a && c.other == b) return fmt::format("{:.3f} ({})", c.ratio, c.runs);
  }
  return "–";
}

void append_comparisons(std::string& text, const SuiteSummary& suite) {
  if (suite.comparisons.empty()) return;
  text +=
      "\n### Makespans side by side\n\n"
      "Geometric mean of the row's makespan divided by the column's, over the runs (their number "
      "in "
      "brackets) in which both succeeded.\n\n| |";
  for (const std::string& b : suite.algorithms) text += fmt::format(" {} |", cell_text(b));
  text += "\n|---|";
  for (std::size_t i = 0; i < suite.algorithms.size(); ++i) text += "---:|";
  for (const std::string& a : suite.algorithms) {
    text += fmt::format("\n| {} |", cell_text(a));
    for (const std::string& b : suite.algorithms) {
      text += fmt::format(" {} |", comparison_text(suite, a, b));
    }
  }
  text += '\n';
}

std::string how_to_read(std::optional<double> time_limit) {
  const std::string unsolved =
      time_limit
          ? fmt::format("a run without success counts as the time limit of {:g} s", *time_limit)
          : "a run without success counts with what it took";
  return fmt::format(
      "\n## How to read this\n\n"
      "- **valid**: plans that the referee accepts, of all runs. Only these are successes.\n"
      "- **makespan**, **makespan / bound**, **first solution**: mean (± standard deviation of the "
      "sample) over the algorithm's own successes, so that an algorithm which fails on hard "
      "instances shows the makespans of easy ones; the side-by-side table does not have this "
      "flaw.\n"
      "- **bound**: the longest Reeds-Shepp path of any robot at full speed; no plan is shorter.\n"
      "- **runtime**: mean over all runs; {}.\n"
      "- **peak memory**: the largest of all runs.\n",
      unsolved);
}

// ---- JSON

Json value_or_null(const std::optional<MeanAndDeviation>& value) {
  return value ? Json(value->mean) : Json();
}

/// The points of one line in all three rows of the figure.
Json series(const MapSummary& map, const std::string& algorithm) {
  Json result = {{"algorithm", algorithm}};
  for (const char* key : {"robots", "success", "makespan", "deviation", "runtime"}) {
    result[key] = Json::array();
  }
  for (const CellSummary& cell : map.cells) {
    if (cell.algorithm != algorithm || !cell.robots) continue;
    result["robots"].push_back(*cell.robots);
    result["success"].push_back(100.0 * cell.valid / cell.runs);
    result["makespan"].push_back(value_or_null(cell.makespan_steps));
    result["deviation"].push_back(
        cell.makespan_steps ? Json(cell.makespan_steps->deviation.value_or(0.0)) : Json());
    result["runtime"].push_back(cell.runtime.mean);
  }
  return result;
}

}  // namespace

std::string to_markdown(std::span<const SuiteSummary> suites, std::optional<double> time_limit) {
  std::string text = "# Results\n";
  for (const SuiteSummary& suite : suites) {
    text += fmt::format("\n## {}\n", suite.suite);
    for (const MapSummary& map : suite.maps) append_map(text, map);
    append_comparisons(text, suite);
  }
  return text + how_to_read(time_limit);
}

std::string to_json(std::span<const SuiteSummary> suites, std::optional<double> time_limit) {
  Json figures = Json::array();
  for (const SuiteSummary& suite : suites) {
    Json panels = Json::array();
    for (const MapSummary& map : suite.maps) {
      Json lines = Json::array();
      for (const std::string& algorithm : suite.algorithms) {
        Json line = series(map, algorithm);
        if (!line["robots"].empty()) lines.push_back(std::move(line));
      }
      if (!lines.empty()) panels.push_back({{"map", map.map}, {"lines", std::move(lines)}});
    }
    if (!panels.empty()) figures.push_back({{"name", suite.suite}, {"panels", std::move(panels)}});
  }
  const Json document = {{"time_limit", time_limit ? Json(*time_limit) : Json()},
                         {"figures", std::move(figures)}};
  return document.dump(1) + '\n';
}

}  // namespace mvtp
