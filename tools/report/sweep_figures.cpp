#include "tools/report/sweep_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

#include "tools/report/arrivals.hpp"
#include "tools/runs/mean.hpp"

namespace mvtp {
namespace {

using Json = ReportJson;

/// Rows that differ in their seeds only.
using CellKey = std::tuple<std::string, double, double, std::string>;  // the order of the table
using Cells = std::map<CellKey, std::vector<const SweepRow*>>;

Cells cells_of(std::span<const SweepRow> rows) {
  Cells cells;
  for (const SweepRow& row : rows) {
    cells[{row.scenario, row.scale, row.penetration, row.controller}].push_back(&row);
  }
  return cells;
}

std::optional<MeanAndDeviation> mean_of(const std::vector<const SweepRow*>& rows,
                                        const std::string& figure) {
  std::vector<double> values;
  for (const SweepRow* row : rows) {
    if (const auto value = row->figures.find(figure); value != row->figures.end()) {
      values.push_back(value->second);
    }
  }
  if (values.empty()) return std::nullopt;
  return mean_and_deviation(values);
}

std::string text_of(const std::optional<MeanAndDeviation>& value, int digits) {
  if (!value) return "–";
  std::string text = fmt::format("{:.{}f}", value->mean, digits);
  if (value->deviation) text += fmt::format(" ± {:.{}f}", *value->deviation, digits);
  return text;
}

/// The controllers in the order in which they first appear.
std::vector<std::string> controllers_of(std::span<const SweepRow> rows) {
  std::vector<std::string> names;
  for (const SweepRow& row : rows) {
    if (std::ranges::find(names, row.controller) == names.end()) names.push_back(row.controller);
  }
  return names;
}

std::set<std::string> scenarios_of(std::span<const SweepRow> rows) {
  std::set<std::string> names;
  for (const SweepRow& row : rows) names.insert(row.scenario);
  return names;
}

/// Ascending.
template <class Value>
std::set<double> values_of(std::span<const SweepRow> rows, Value value) {
  std::set<double> all;
  for (const SweepRow& row : rows) all.insert(value(row));
  return all;
}

std::vector<SweepRow> rows_where(std::span<const SweepRow> rows, auto test) {
  std::vector<SweepRow> some;
  std::ranges::copy_if(rows, std::back_inserter(some), test);
  return some;
}

double scale_of(const SweepRow& row) { return row.scale; }
double penetration_of(const SweepRow& row) { return row.penetration; }

/// A line of delays over what `x` says of the rows.
/// @param figure  whose delays.
Json delay_line(const std::string& label, std::span<const SweepRow> rows,
                double (*x)(const SweepRow&), const std::string& figure = "delay_mean_s") {
  Json line = {{"label", label}, {"x", Json::array()}, {"y", Json::array()}, {"sd", Json::array()}};
  for (const double at : values_of(rows, x)) {
    std::vector<const SweepRow*> there;
    for (const SweepRow& row : rows) {
      if (x(row) == at) there.push_back(&row);
    }
    const auto delay = mean_of(there, figure);
    if (!delay) continue;
    line["x"].push_back(at);
    line["y"].push_back(delay->mean);
    line["sd"].push_back(delay->deviation.value_or(0.0));
  }
  return line;
}

void add_line(Json line, Json& lines) {
  if (!line["x"].empty()) lines.push_back(std::move(line));
}

/// A controller with several penetrations has a line for each.
Json delay_over_demand(std::span<const SweepRow> rows) {
  Json panels = Json::array();
  for (const std::string& scenario : scenarios_of(rows)) {
    Json lines = Json::array();
    for (const std::string& controller : controllers_of(rows)) {
      const auto own = rows_where(rows, [&](const SweepRow& r) {
        return r.scenario == scenario && r.controller == controller;
      });
      const std::set<double> shares = values_of(std::span(own), penetration_of);
      for (const double share : shares) {
        const auto some =
            rows_where(own, [&](const SweepRow& r) { return r.penetration == share; });
        const std::string label =
            shares.size() < 2 ? controller : fmt::format("{} {:g} %", controller, 100.0 * share);
        add_line(delay_line(label, some, scale_of), lines);
      }
    }
    panels.push_back({{"title", scenario}, {"lines", std::move(lines)}});
  }
  return {{"name", "delay-over-demand"},
          {"x", "Demand (multiple of the scenario's)"},
          {"y", "Mean delay [s]"},
          {"panels", std::move(panels)}};
}

/// A controller that drives nobody is the same at every penetration. One that drives some has a
/// line for all vehicles, one for those under control and one for the human-driven ones.
Json delay_over_penetration(std::span<const SweepRow> rows) {
  Json panels = Json::array();
  const std::set<double> all = values_of(rows, penetration_of);
  for (const std::string& scenario : scenarios_of(rows)) {
    for (const double scale : values_of(rows, scale_of)) {
      Json lines = Json::array();
      for (const std::string& controller : controllers_of(rows)) {
        const auto own = rows_where(rows, [&](const SweepRow& r) {
          return r.scenario == scenario && r.controller == controller && r.scale == scale;
        });
        Json line = delay_line(controller, own, penetration_of);
        if (line["x"] == Json({0.0})) {
          line["x"] = {*all.begin(), *all.rbegin()};
          line["y"] = {line["y"][0], line["y"][0]};
          line["sd"] = {line["sd"][0], line["sd"][0]};
        }
        const bool mixed =
            line["x"].size() > 1 && values_of(std::span(own), penetration_of).size() > 1;
        add_line(std::move(line), lines);
        if (!mixed) continue;
        add_line(
            delay_line(controller + ", under control", own, penetration_of, "delay_controlled_s"),
            lines);
        add_line(delay_line(controller + ", human-driven", own, penetration_of, "delay_human_s"),
                 lines);
      }
      if (lines.empty()) continue;
      panels.push_back({{"title", fmt::format("{}, demand x {:g}", scenario, scale)},
                        {"lines", std::move(lines)}});
    }
  }
  return {{"name", "delay-over-penetration"},
          {"x", "Share of vehicles under control"},
          {"y", "Mean delay [s]"},
          {"panels", std::move(panels)}};
}

/// Of controllers that drive, at their largest penetration.
Json arrivals_by_minute(std::span<const SweepRow> rows) {
  Json panels = Json::array();
  for (const std::string& scenario : scenarios_of(rows)) {
    for (const double scale : values_of(rows, scale_of)) {
      Json lines = Json::array();
      for (const std::string& controller : controllers_of(rows)) {
        auto own = rows_where(rows, [&](const SweepRow& r) {
          return r.scenario == scenario && r.controller == controller && r.scale == scale;
        });
        if (own.empty()) continue;
        const double most = *values_of(std::span(own), penetration_of).rbegin();
        std::erase_if(own, [&](const SweepRow& r) { return r.penetration != most; });
        add_line(arrivals_line(controller, own), lines);
      }
      if (lines.empty()) continue;
      panels.push_back({{"title", fmt::format("{}, demand x {:g}", scenario, scale)},
                        {"lines", std::move(lines)}});
    }
  }
  return arrivals_figure(std::move(panels));
}

}  // namespace

std::string sweep_to_markdown(std::span<const SweepRow> rows) {
  std::string text =
      "# Results\n\nMean ± standard deviation of the sample over the seeds; overlaps are sums.\n\n"
      "| scenario | demand | penetration | controller | runs | delay [s] | 95 % [s] | throughput "
      "[veh/h] | stops | CO2 [g] | PET < 1 s | overlaps with a coordinated vehicle |\n"
      "|---|---:|---:|---|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  for (const auto& [key, cell] : cells_of(rows)) {
    const auto& [scenario, scale, share, controller] = key;
    double overlaps = 0.0;
    std::size_t with_figures = 0;
    for (const SweepRow* row : cell) {
      with_figures += row->figures.contains("delay_mean_s") ? 1 : 0;
      const auto found = row->figures.find("overlap_pairs_coordinated");
      if (found != row->figures.end()) overlaps += found->second;
    }
    text += fmt::format(
        "| {} | {:g} | {:g} | {} | {}/{} | {} | {} | {} | {} | {} | {} | {:.0f} |\n", scenario,
        scale, share, controller, with_figures, cell.size(),
        text_of(mean_of(cell, "delay_mean_s"), 2), text_of(mean_of(cell, "delay_p95_s"), 1),
        text_of(mean_of(cell, "throughput_veh_h"), 0),
        text_of(mean_of(cell, "stops_per_vehicle"), 2), text_of(mean_of(cell, "co2_g"), 0),
        text_of(mean_of(cell, "pet_below_1s"), 0), overlaps);
  }
  return text;
}

std::string sweep_to_json(std::span<const SweepRow> rows) {
  Json figures = Json::array({delay_over_demand(rows)});
  const std::vector<std::string> controllers = controllers_of(rows);
  const bool several = std::ranges::any_of(controllers, [&](const std::string& controller) {
    const auto own =
        rows_where(rows, [&](const SweepRow& r) { return r.controller == controller; });
    return values_of(std::span(own), penetration_of).size() > 1;
  });
  if (several) figures.push_back(delay_over_penetration(rows));
  figures.push_back(arrivals_by_minute(rows));
  return Json{{"sweep", true}, {"figures", std::move(figures)}}.dump(1) + '\n';
}

}  // namespace mvtp
