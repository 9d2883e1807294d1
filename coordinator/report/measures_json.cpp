#include "coordinator/report/measures_json.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/measures/statistics.hpp"

namespace mvtp {
namespace {

using Json = nlohmann::ordered_json;

/// Means over the vehicles of which they are known; null if of none.
Json emissions_json(const RunReport& report) {
  Emissions sum;
  int known = 0;
  for (const VehicleRecord& v : report.vehicles) {
    if (!v.emissions) continue;
    sum.fuel += v.emissions->fuel;
    sum.co2 += v.emissions->co2;
    sum.nox += v.emissions->nox;
    ++known;
  }
  if (known == 0) return {{"fuel_ml", nullptr}, {"co2_g", nullptr}, {"nox_g", nullptr}};
  return {{"fuel_ml", sum.fuel / known}, {"co2_g", sum.co2 / known}, {"nox_g", sum.nox / known}};
}

Json conflict_json(const ConflictFigures& figures) {
  return {{"min", std::isfinite(figures.least) ? Json(figures.least) : Json()},
          {"below_1s", figures.below_1s},
          {"pairs", figures.pairs},
          {"by_half_second", figures.counts}};
}

Json p95_over_mean(const std::vector<double>& delays) {
  const double all = mean(delays);
  return all > 0.0 ? Json(quantile(delays, 0.95) / all) : Json();
}

/// Of some vehicles that departed.
struct GroupFigures {
  std::vector<double> delays;
  std::vector<double> stops;
  std::vector<double> standing;
  std::vector<double> co2;  ///< of those of which it is known
};

/// Figures of the vehicles that departed, by what `name` says of each.
template <class Name>
Json figures_by(const RunReport& report, Name name) {
  std::map<std::string, GroupFigures> groups;
  for (const VehicleRecord& v : report.vehicles) {
    if (!v.departure) continue;
    GroupFigures& group = groups[name(v)];
    group.delays.push_back(delay_of(v, report.end));
    group.stops.push_back(v.driving.stops);
    group.standing.push_back(v.driving.standing);
    if (v.emissions) group.co2.push_back(v.emissions->co2);
  }
  Json result = Json::object();
  for (const auto& [key, group] : groups) {
    result[key] = {{"vehicles", group.delays.size()},
                   {"mean", mean(group.delays)},
                   {"p95", quantile(group.delays, 0.95)},
                   {"max", largest(group.delays)},
                   {"p95_over_mean", p95_over_mean(group.delays)},
                   {"stops_per_vehicle", mean(group.stops)},
                   {"longest_wait_s", largest(group.standing)},
                   {"co2_g", group.co2.empty() ? Json() : Json(mean(group.co2))}};
  }
  return result;
}

Json fairness_json(const RunReport& report) {
  std::vector<double> delays;
  std::vector<double> standing;
  for (const VehicleRecord& v : report.vehicles) {
    delays.push_back(delay_of(v, report.end));
    standing.push_back(v.driving.standing);
  }
  return {{"p95_over_mean", p95_over_mean(delays)}, {"longest_wait_s", largest(standing)}};
}

/// How many arrived in each minute of the run, the last one begun included.
Json arrivals_by_minute(const RunReport& report) {
  constexpr double kMinute = 60.0;
  const auto minutes = std::size_t(std::ceil((report.end - report.begin) / kMinute - 1e-9));
  std::vector<std::int64_t> arrivals(minutes, 0);
  for (const VehicleRecord& v : report.vehicles) {
    if (!v.arrival || minutes == 0) continue;
    const auto minute = std::size_t(std::max(0.0, (*v.arrival - report.begin) / kMinute));
    ++arrivals[std::min(minute, minutes - 1)];
  }
  return arrivals;
}

}  // namespace

void add_measures(const RunReport& report, Json& summary) {
  std::vector<double> stops;
  std::vector<double> jerks;
  for (const VehicleRecord& v : report.vehicles) {
    if (!v.departure) continue;
    stops.push_back(v.driving.stops);
    jerks.push_back(v.driving.jerk);
  }
  summary["emissions"] = emissions_json(report);
  summary["stops_per_vehicle"] = mean(stops);
  summary["jerk_m_s3"] = {{"mean", mean(jerks)}, {"p95", quantile(jerks, 0.95)}};
  summary["pet_s"] = conflict_json(report.pet);
  summary["ttc_s"] = conflict_json(report.ttc);
  summary["fairness"] = fairness_json(report);
  summary["delay_by_type_s"] = figures_by(report, [](const VehicleRecord& v) { return v.type; });
  summary["delay_by_movement_s"] =
      figures_by(report, [](const VehicleRecord& v) { return v.movement; });
  summary["arrivals_per_minute"] = arrivals_by_minute(report);
}

}  // namespace mvtp
