#include "tools/runs/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <nlohmann/json.hpp>

#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"

namespace mvtp {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kFigures = {
    ComparedFigure{"vehicles", "/vehicles"},
    ComparedFigure{"never_departed", "/never_departed"},
    ComparedFigure{"completed", "/completed"},
    ComparedFigure{"delay_mean_s", "/delay_s/mean"},
    ComparedFigure{"delay_p50_s", "/delay_s/p50"},
    ComparedFigure{"delay_p95_s", "/delay_s/p95"},
    ComparedFigure{"delay_max_s", "/delay_s/max"},
    ComparedFigure{"delay_controlled_s", "/delay_controlled_s/mean"},
    ComparedFigure{"delay_human_s", "/delay_human_s/mean"},
    ComparedFigure{"delay_emergency_s", "/delay_priority_s/emergency/mean"},
    ComparedFigure{"delay_bus_s", "/delay_priority_s/bus/mean"},
    ComparedFigure{"throughput_veh_h", "/throughput_veh_h"},
    ComparedFigure{"time_loss_s", "/time_loss_s"},
    ComparedFigure{"depart_delay_s", "/depart_delay_s"},
    ComparedFigure{"waiting_time_s", "/waiting_time_s"},
    ComparedFigure{"stops_per_vehicle", "/stops_per_vehicle"},
    ComparedFigure{"jerk_m_s3", "/jerk_m_s3/mean"},
    ComparedFigure{"longest_wait_s", "/fairness/longest_wait_s"},
    ComparedFigure{"delay_p95_over_mean", "/fairness/p95_over_mean"},
    ComparedFigure{"fuel_ml", "/emissions/fuel_ml"},
    ComparedFigure{"co2_g", "/emissions/co2_g"},
    ComparedFigure{"nox_g", "/emissions/nox_g"},
    ComparedFigure{"pet_min_s", "/pet_s/min"},
    ComparedFigure{"pet_below_1s", "/pet_s/below_1s"},
    ComparedFigure{"ttc_min_s", "/ttc_s/min"},
    ComparedFigure{"ttc_below_1s", "/ttc_s/below_1s"},
    ComparedFigure{"overlap_pairs", "/audit/overlap_pairs"},
    ComparedFigure{"overlap_pairs_coordinated", "/overlap_pairs_coordinated"},
    ComparedFigure{"min_clearance_m", "/audit/min_clearance_m"},
    ComparedFigure{"off_road_steps", "/audit/off_road_steps"},
    ComparedFigure{"off_road_steps_coordinated", "/audit/off_road_steps_coordinated"},
    ComparedFigure{"people_touched", "/people/touched"},
    ComparedFigure{"people_touched_coordinated", "/people/touched_coordinated"},
    ComparedFigure{"people_wait_s", "/people/wait_s"},
    ComparedFigure{"sumo_collisions", "/sumo_collisions"},
    ComparedFigure{"max_accel", "/max_accel"},
    ComparedFigure{"max_decel", "/max_decel"},
    ComparedFigure{"accel_violations", "/accel_violations"},
    ComparedFigure{"max_lateral_accel", "/max_lateral_accel"},
    ComparedFigure{"max_curvature_ratio", "/max_curvature_ratio"},
    ComparedFigure{"max_jump_m", "/max_jump_m"},
    ComparedFigure{"hard_brakings_after_handback", "/hard_brakings_after_handback"},
    ComparedFigure{"replans", "/replans"},
    ComparedFigure{"fallbacks", "/fallbacks"},
    ComparedFigure{"replan_p50_ms", "/replan_ms/p50"},
    ComparedFigure{"replan_p95_ms", "/replan_ms/p95"},
    ComparedFigure{"replan_p99_ms", "/replan_ms/p99"},
    ComparedFigure{"replan_max_ms", "/replan_ms/max"},
    ComparedFigure{"simulated_s", "/simulated_s"},
    ComparedFigure{"real_time_factor", "/real_time_factor"},
};

constexpr std::array kParkingFigures = {
    ComparedFigure{"gate_to_parked_mean_s", "/parking/gate_to_parked_s/mean"},
    ComparedFigure{"gate_to_parked_p95_s", "/parking/gate_to_parked_s/p95"},
    ComparedFigure{"gate_to_parked_alone_s", "/parking/gate_to_parked_s/alone_mean"},
    ComparedFigure{"slot_to_exit_mean_s", "/parking/slot_to_exit_s/mean"},
    ComparedFigure{"slot_to_exit_p95_s", "/parking/slot_to_exit_s/p95"},
    ComparedFigure{"slot_to_exit_alone_s", "/parking/slot_to_exit_s/alone_mean"},
    ComparedFigure{"at_gate_max", "/parking/at_gate_max"},
    ComparedFigure{"reversals_mean", "/parking/reversals_mean"},
};

bool is_parking(std::span<const ComparedRun> runs) {
  return std::ranges::any_of(
      runs, [](const auto& run) { return run.figures.contains(kParkingFigures.front().name); });
}

std::vector<ComparedFigure> all_figures(bool parking) {
  std::vector<ComparedFigure> figures(kFigures.begin(), kFigures.end());
  if (parking) {
    figures.insert(figures.end(), kParkingFigures.begin(), kParkingFigures.end());
  }
  return figures;
}

/// The runs of one control.
struct Row {
  std::string control;
  std::vector<const ComparedRun*> runs;  ///< those with figures
  std::size_t planned = 0;
};

std::vector<Row> rows_of(std::span<const ComparedRun> runs) {
  std::vector<Row> rows;
  for (const ComparedRun& run : runs) {
    auto row = std::ranges::find(rows, run.control, &Row::control);
    if (row == rows.end()) row = rows.insert(rows.end(), {run.control, {}, 0});
    ++row->planned;
    if (run.failure.empty()) row->runs.push_back(&run);
  }
  return rows;
}

std::vector<double> values_of(const Row& row, const std::string& figure) {
  std::vector<double> values;
  for (const ComparedRun* run : row.runs) {
    if (const auto value = run->figures.find(figure); value != run->figures.end()) {
      values.push_back(value->second);
    }
  }
  return values;
}

double sum(const std::vector<double>& values) {
  double total = 0.0;
  for (const double value : values) total += value;
  return total;
}

/// "2.25 ± 0.31", or "2.25" of a single run, or "-" if there is none.
std::string spread_cell(const Row& row, const char* figure, int digits) {
  const std::vector<double> values = values_of(row, figure);
  if (values.empty()) return "-";
  const MeanAndDeviation m = mean_and_deviation(values);
  std::string cell = fmt::format("{:.{}f}", m.mean, digits);
  if (m.deviation) cell += fmt::format(" ± {:.{}f}", *m.deviation, digits);
  return cell;
}

std::string mean_cell(const Row& row, const char* figure, int digits) {
  const std::vector<double> values = values_of(row, figure);
  if (values.empty()) return "-";
  return fmt::format("{:.{}f}", mean_and_deviation(values).mean, digits);
}

std::string sum_cell(const Row& row, const char* figure) {
  return row.runs.empty() ? "-" : fmt::format("{:.0f}", sum(values_of(row, figure)));
}

std::string arrived_cell(const Row& row) {
  if (row.runs.empty()) return "-";
  return fmt::format("{:.0f}/{:.0f}", sum(values_of(row, "completed")),
                     sum(values_of(row, "vehicles")) + sum(values_of(row, "never_departed")));
}

using Cells = std::vector<std::string>;

/// A column of the table: its title, and what it says of the runs of one control.
struct Column {
  const char* title;
  std::function<std::string(const Row&)> cell;
};

Column spread_column(const char* title, const char* figure, int digits) {
  return {title, [=](const Row& row) { return spread_cell(row, figure, digits); }};
}

Column mean_column(const char* title, const char* figure, int digits) {
  return {title, [=](const Row& row) { return mean_cell(row, figure, digits); }};
}

std::string runs_cell(const Row& row) { return fmt::format("{}/{}", row.runs.size(), row.planned); }

std::string overlaps_cell(const Row& row) { return sum_cell(row, "overlap_pairs"); }

/// Pairs of a vehicle and a person.
std::string touched_cell(const Row& row) { return sum_cell(row, "people_touched"); }

std::string replan_cell(const Row& row) {
  const bool coordinated = sum(values_of(row, "replans")) > 0.0;
  return coordinated ? mean_cell(row, "replan_p95_ms", 1) : "-";
}

const std::array kColumns = {Column{"control", &Row::control},
                             Column{"runs", runs_cell},
                             spread_column("delay [s]", "delay_mean_s", 2),
                             mean_column("95 % [s]", "delay_p95_s", 1),
                             spread_column("throughput [veh/h]", "throughput_veh_h", 0),
                             Column{"arrived", arrived_cell},
                             Column{"overlaps", overlaps_cell},
                             Column{"people touched", touched_cell},
                             mean_column("PET < 1 s", "pet_below_1s", 0),
                             mean_column("stops", "stops_per_vehicle", 2),
                             mean_column("CO2 [g]", "co2_g", 0),
                             mean_column("waiting [s]", "waiting_time_s", 1),
                             Column{"replan 95 % [ms]", replan_cell},
                             mean_column("x real time", "real_time_factor", 0)};

const std::array kParkingColumns = {Column{"control", &Row::control},
                                    Column{"runs", runs_cell},
                                    spread_column("gate to parked [s]", "gate_to_parked_mean_s", 1),
                                    mean_column("95 % [s]", "gate_to_parked_p95_s", 1),
                                    mean_column("alone [s]", "gate_to_parked_alone_s", 1),
                                    spread_column("slot to exit [s]", "slot_to_exit_mean_s", 1),
                                    mean_column("95 % [s]", "slot_to_exit_p95_s", 1),
                                    mean_column("alone [s]", "slot_to_exit_alone_s", 1),
                                    Column{"arrived", arrived_cell},
                                    Column{"overlaps", overlaps_cell},
                                    Column{"people touched", touched_cell},
                                    mean_column("longest queue", "at_gate_max", 0),
                                    mean_column("replan 95 % [ms]", "replan_p95_ms", 1),
                                    mean_column("x real time", "real_time_factor", 0)};

/// Columns about emergency vehicles and buses come only with such vehicles.
std::vector<Column> columns_for(std::span<const ComparedRun> runs) {
  if (is_parking(runs)) return {kParkingColumns.begin(), kParkingColumns.end()};
  std::vector<Column> columns(kColumns.begin(), kColumns.end());
  constexpr std::ptrdiff_t kBehindDelays = 4;
  auto at = columns.begin() + kBehindDelays;
  for (const auto& [title, figure] :
       {std::pair{"emergency [s]", "delay_emergency_s"}, {"buses [s]", "delay_bus_s"}}) {
    const auto has_it = [&](const ComparedRun& run) { return run.figures.contains(figure); };
    if (std::ranges::none_of(runs, has_it)) continue;
    at = columns.insert(at, mean_column(title, figure, 1)) + 1;
  }
  return columns;
}

std::size_t display_width(const std::string& text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string aligned(const std::vector<Cells>& lines) {
  std::vector<std::size_t> widths(lines.front().size(), 0);
  for (const Cells& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      widths[i] = std::max(widths[i], display_width(line[i]));
    }
  }
  std::string text;
  for (const Cells& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      const std::string padding(widths[i] - display_width(line[i]), ' ');
      text += i == 0 ? line[i] + padding : "  " + padding + line[i];
    }
    text += '\n';
  }
  return text;
}

}  // namespace

std::span<const ComparedFigure> compared_figures() { return kFigures; }

void read_summary(const std::string& text, const std::string& where, ComparedRun& run) {
  const Json summary = Json::parse(text, nullptr, false);
  if (!summary.is_object() || !summary.contains("status") || !summary["status"].is_string()) {
    throw InputError(where, "is no summary of a run");
  }
  run.status = summary["status"];
  for (const ComparedFigure& figure : all_figures(summary.contains("parking"))) {
    const Json::json_pointer pointer(figure.pointer);
    if (!summary.contains(pointer)) {
      throw InputError(where, fmt::format("lacks the figure {}", figure.pointer));
    }
    if (const Json& value = summary[pointer]; value.is_number()) run.figures[figure.name] = value;
  }
  run.failure.clear();
}

bool succeeded(const ComparedRun& run) {
  if (!run.failure.empty()) return false;
  if (!run.drives) return true;
  return run.status != "stuck" && run.figures.at("overlap_pairs_coordinated") == 0.0 &&
         run.figures.at("people_touched_coordinated") == 0.0;
}

std::string comparison_table(std::span<const ComparedRun> runs) {
  const std::vector<Column> columns = columns_for(runs);
  std::vector<Cells> lines(1);
  for (const Column& column : columns) lines.front().push_back(column.title);
  for (const Row& row : rows_of(runs)) {
    Cells& cells = lines.emplace_back();
    for (const Column& column : columns) cells.push_back(column.cell(row));
  }
  std::string text = aligned(lines);
  for (const ComparedRun& run : runs) {
    if (!run.failure.empty()) {
      text += fmt::format("FAILED: {}, seed {}: {}\n", run.control, run.seed, run.failure);
    } else if (run.status != "finished") {
      text += fmt::format("{}, seed {}: {} after {:.0f} s\n", run.control, run.seed, run.status,
                          run.figures.at("simulated_s"));
    }
  }
  return text;
}

std::string comparison_csv(std::span<const ComparedRun> runs) {
  std::string text = "control,seed,status,failure,folder";
  const std::vector<ComparedFigure> figures = all_figures(is_parking(runs));
  for (const ComparedFigure& figure : figures) text += fmt::format(",{}", figure.name);
  text += '\n';
  for (const ComparedRun& run : runs) {
    text += fmt::format("{},{},{},{},{}", csv_field(run.control), run.seed, run.status,
                        csv_field(run.failure), csv_field(run.folder));
    for (const ComparedFigure& figure : figures) {
      const auto value = run.figures.find(figure.name);
      text += value == run.figures.end() ? "," : fmt::format(",{:.10g}", value->second);
    }
    text += '\n';
  }
  return text;
}

std::string comparison_json(std::span<const ComparedRun> runs, const std::string& scenario,
                            const std::string& version, const std::string& command) {
  const std::vector<ComparedFigure> figures = all_figures(is_parking(runs));
  Json controls = Json::array();
  for (const Row& row : rows_of(runs)) {
    Json control = {{"control", row.control},
                    {"runs", row.runs.size()},
                    {"failed", row.planned - row.runs.size()}};
    for (const ComparedFigure& figure : figures) {
      const std::vector<double> values = values_of(row, figure.name);
      if (values.empty()) {
        control[figure.name] = nullptr;
        continue;
      }
      const MeanAndDeviation m = mean_and_deviation(values);
      control[figure.name] = {{"mean", m.mean}, {"sd", m.deviation ? Json(*m.deviation) : Json()}};
    }
    controls.push_back(std::move(control));
  }
  const Json json = {{"scenario", scenario},
                     {"controls", std::move(controls)},
                     {"mvtp_version", version},
                     {"command", command}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace mvtp
