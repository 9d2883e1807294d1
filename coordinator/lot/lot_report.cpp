#include "coordinator/lot/lot_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "coordinator/measures/statistics.hpp"
#include "planner/problem/text_file.hpp"

namespace mvtp {
namespace {

using Json = nlohmann::ordered_json;

/// Of all who made one of the two trips.
struct Travel {
  std::vector<double> took;   ///< [s] those not at the end counted up to now
  std::vector<double> alone;  ///< [s] of those who got a path
  int unfinished = 0;
};

Json travel_json(const Travel& travel) {
  const double alone = mean(travel.alone);
  return {{"vehicles", travel.took.size()},
          {"unfinished", travel.unfinished},
          {"mean", mean(travel.took)},
          {"p50", quantile(travel.took, 0.5)},
          {"p95", quantile(travel.took, 0.95)},
          {"max", largest(travel.took)},
          {"alone_mean", alone},
          {"ratio_to_alone", alone > 0.0 ? Json(mean(travel.took) / alone) : Json()}};
}

template <class Value>
double mean_of(const LotReport& report, Value value) {
  std::vector<double> values;
  for (const ParkingRecord& r : report.events) {
    if (r.event.distance > 0.0) values.push_back(value(r.event));
  }
  return mean(values);
}

std::string cell(const std::optional<double>& value) {
  return value ? fmt::format("{:.2f}", *value) : std::string();
}

}  // namespace

std::optional<double> time_in(const ParkingRecord& record, double end) {
  if (!record.at_gate || *record.at_gate > end) return std::nullopt;
  return record.event.parked.value_or(end) - *record.at_gate;
}

std::optional<double> time_out(const ParkingRecord& record, double end) {
  if (!record.event.wished_out) return std::nullopt;
  return record.event.handed_back.value_or(end) - *record.event.wished_out;
}

namespace {

Json lot_json(const LotReport& report, double end) {
  Travel in;
  Travel out;
  Json broken = Json::array();
  Json stopped_permanently = Json::array();
  for (const ParkingRecord& r : report.events) {
    if (const auto took = time_in(r, end)) in.took.push_back(*took);
    if (const auto took = time_out(r, end)) out.took.push_back(*took);
    in.unfinished += time_in(r, end) && !r.event.parked ? 1 : 0;
    out.unfinished += time_out(r, end) && !r.event.handed_back ? 1 : 0;
    if (r.event.admitted_in) in.alone.push_back(r.event.alone_in);
    if (r.event.admitted_out) out.alone.push_back(r.event.alone_out);
    if (r.event.broken) broken.push_back(r.event.id);
    if (r.event.stopped_permanently) stopped_permanently.push_back(r.event.id);
  }
  std::vector<double> parked;
  std::vector<double> queue;
  std::vector<double> under_way;
  for (const Occupied& o : report.occupancy) {
    parked.push_back(o.parked);
    queue.push_back(o.at_gate);
    under_way.push_back(o.under_way);
  }
  return {{"lot", report.lot},
          {"slots", report.slots},
          {"gate_to_parked_s", travel_json(in)},
          {"slot_to_exit_s", travel_json(out)},
          {"reversals_mean", mean_of(report, [](const ParkingEvent& v) { return v.reversals; })},
          {"distance_mean_m", mean_of(report, [](const ParkingEvent& v) { return v.distance; })},
          {"waited_mean_s", mean_of(report, [](const ParkingEvent& v) { return v.waited; })},
          {"parked_mean", mean(parked)},
          {"parked_max", largest(parked)},
          {"under_way_max", largest(under_way)},
          {"at_gate_max", largest(queue)},
          {"at_gate_end", queue.empty() ? 0.0 : queue.back()},
          {"broken_down", std::move(broken)},
          {"stranded", std::move(stopped_permanently)}};
}

/// All lots as one.
LotReport merged(std::span<const LotReport> lots) {
  LotReport all = lots.front();
  for (const LotReport& lot : lots.subspan(1)) {
    all.lot += ", " + lot.lot;
    all.slots += lot.slots;
    all.events.insert(all.events.end(), lot.events.begin(), lot.events.end());
    for (std::size_t i = 0; i < std::min(all.occupancy.size(), lot.occupancy.size()); ++i) {
      all.occupancy[i].parked += lot.occupancy[i].parked;
      all.occupancy[i].under_way += lot.occupancy[i].under_way;
      all.occupancy[i].at_gate += lot.occupancy[i].at_gate;
    }
  }
  std::ranges::sort(all.events, {}, [](const ParkingRecord& r) { return r.event.id; });
  return all;
}

}  // namespace

Json lots_json(std::span<const LotReport> lots, double end) {
  Json json = lot_json(merged(lots), end);
  if (lots.size() < 2) return json;
  for (const LotReport& lot : lots) json["lots"].push_back(lot_json(lot, end));
  return json;
}

std::string parking_events_csv(std::span<const LotReport> lots, double end) {
  const LotReport report = merged(lots);
  std::string text =
      "id,slot,at_gate_s,asked_in_s,admitted_in_s,parked_s,wished_out_s,admitted_out_s,"
      "handed_back_s,gate_to_parked_s,alone_in_s,slot_to_exit_s,alone_out_s,distance_m,waited_s,"
      "reversals,broken_down,stranded\n";
  for (const ParkingRecord& r : report.events) {
    const ParkingEvent& v = r.event;
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{:.2f},{},{:.2f},{:.2f},{:.2f},{},{},{}\n",
                        csv_field(v.id), csv_field(v.slot), cell(r.at_gate), cell(v.asked_in),
                        cell(v.admitted_in), cell(v.parked), cell(v.wished_out),
                        cell(v.admitted_out), cell(v.handed_back), cell(time_in(r, end)),
                        v.alone_in, cell(time_out(r, end)), v.alone_out, v.distance, v.waited,
                        v.reversals, v.broken ? 1 : 0, v.stopped_permanently ? 1 : 0);
  }
  return text;
}

std::string occupancy_csv(std::span<const LotReport> lots) {
  const LotReport report = merged(lots);
  std::string text = "time_s,parked,under_way,at_gate\n";
  for (const Occupied& o : report.occupancy) {
    text += fmt::format("{:.1f},{},{},{}\n", o.time, o.parked, o.under_way, o.at_gate);
  }
  return text;
}

}  // namespace mvtp
