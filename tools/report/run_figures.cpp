#include "tools/report/run_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tools/report/arrivals.hpp"
#include "tools/runs/mean.hpp"

namespace mvtp {
namespace {

using Json = ReportJson;

/// Times and stations to 1 cm and 10 ms, which nobody sees in a picture.
double hundredths(double value) { return std::round(value * 100.0) / 100.0; }

Json to_json(std::span<const double> values) {
  Json numbers = Json::array();
  for (const double value : values) numbers.push_back(hundredths(value));
  return numbers;
}

Json to_json(const Stretch& stretch) { return {hundredths(stretch.from), hundredths(stretch.to)}; }

Json to_json(const std::vector<Stretch>& stretches) {
  Json all = Json::array();
  for (const Stretch& stretch : stretches) all.push_back(to_json(stretch));
  return all;
}

Json to_json(const std::vector<TimeSpaceLine>& lines) {
  Json all = Json::array();
  for (const TimeSpaceLine& line : lines) {
    all.push_back({{"driver", line.driver},
                   {"x", to_json(std::span(line.times))},
                   {"y", to_json(std::span(line.stations))}});
  }
  return all;
}

Json to_json(const TimeSpacePanel& panel) {
  Json signals = Json::array();
  for (const TimeSpaceSignal& signal : panel.signals) {
    Json shown = Json::array();
    for (const auto& [time, light] : signal.shown) {
      shown.push_back({{"time", to_json(time)}, {"light", std::string(1, light)}});
    }
    signals.push_back({{"y", hundredths(signal.station)}, {"shown", std::move(shown)}});
  }
  return {{"title", panel.label},
          {"lines", to_json(panel.lines)},
          {"others", to_json(panel.others)},
          {"signals", std::move(signals)},
          {"zones", to_json(panel.zones)}};
}

Json to_json(const TimeSpaceDiagram& diagram) {
  Json panels = Json::array();
  for (const TimeSpacePanel& panel : diagram.panels) panels.push_back(to_json(panel));
  return {{"name", "time-space"},
          {"movement", diagram.movement},
          {"time", to_json(diagram.time)},
          {"length", hundredths(diagram.length)},
          {"stop_lines", to_json(std::span(diagram.stop_lines))},
          {"junctions", to_json(diagram.junctions)},
          {"panels", std::move(panels)}};
}

std::vector<std::string> labels_of(std::span<const ReportedRun> runs) {
  std::vector<std::string> labels;
  for (const ReportedRun& run : runs) {
    if (std::ranges::find(labels, run.label) == labels.end()) labels.push_back(run.label);
  }
  return labels;
}

void add_panel(const std::string& title, Json lines, Json& panels) {
  if (!lines.empty()) panels.push_back({{"title", title}, {"lines", std::move(lines)}});
}

Json arrivals_of(std::span<const ReportedRun> runs) {
  Json lines = Json::array();
  for (const std::string& label : labels_of(runs)) {
    std::vector<SweepRow> own;
    for (const ReportedRun& run : runs) {
      if (run.label == label) own.push_back(run.row);
    }
    if (Json line = arrivals_line(label, own); !line["x"].empty()) lines.push_back(line);
  }
  Json panels = Json::array();
  add_panel("", std::move(lines), panels);
  return arrivals_figure(std::move(panels));
}

/// A line for each label, over its runs.
Json distribution_lines(std::span<const ReportedRun> runs,
                        std::vector<double> ReportedRun::*counts) {
  Json lines = Json::array();
  for (const std::string& label : labels_of(runs)) {
    Json line = {
        {"label", label}, {"x", Json::array()}, {"y", Json::array()}, {"sd", Json::array()}};
    for (std::size_t bin = 0;; ++bin) {
      std::vector<double> there;
      for (const ReportedRun& run : runs) {
        if (run.label == label && bin < (run.*counts).size()) there.push_back((run.*counts)[bin]);
      }
      if (there.empty()) break;
      const MeanAndDeviation pairs = mean_and_deviation(there);
      line["x"].push_back(0.5 * double(bin) + 0.25);
      line["y"].push_back(pairs.mean);
      line["sd"].push_back(pairs.deviation.value_or(0.0));
    }
    if (!line["x"].empty()) lines.push_back(std::move(line));
  }
  return lines;
}

Json encounters_of(std::span<const ReportedRun> runs) {
  Json panels = Json::array();
  add_panel("Post-encroachment time", distribution_lines(runs, &ReportedRun::post_encroachment),
            panels);
  add_panel("Time to collision", distribution_lines(runs, &ReportedRun::to_collision), panels);
  return {{"name", "encounters"},
          {"x", "Shortest time [s]"},
          {"y", "Pairs of vehicles per half second"},
          {"panels", std::move(panels)}};
}

}  // namespace

std::string runs_to_json(std::span<const ReportedRun> runs, const TimeSpaceRequest& request) {
  std::vector<LabelledReplay> replays;
  for (const ReportedRun& run : runs) {
    if (!run.replay) continue;
    const bool alone = std::ranges::count(runs, run.label, &ReportedRun::label) == 1;
    const std::string label =
        alone ? run.label : fmt::format("{}, seed {}", run.label, run.row.seed);
    replays.push_back({label, run.page(), &*run.replay});
  }
  Json figures = Json::array();
  if (Json arrivals = arrivals_of(runs); !arrivals["panels"].empty()) {
    figures.push_back(std::move(arrivals));
  }
  if (!replays.empty()) figures.push_back(to_json(time_space_of(replays, request)));
  if (Json encounters = encounters_of(runs); !encounters["panels"].empty()) {
    figures.push_back(std::move(encounters));
  }
  return Json{{"figures", std::move(figures)}}.dump(1) + '\n';
}

}  // namespace mvtp
