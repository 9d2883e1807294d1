#include "coordinator/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "coordinator/measures/statistics.hpp"
#include "coordinator/report/measures_json.hpp"
#include "coordinator/simulation/simulation.hpp"
#include "planner/problem/text_file.hpp"

namespace mvtp {
namespace {

using Json = nlohmann::ordered_json;

template <class Range, class Function>
std::vector<double> collect(const Range& range, Function value) {
  std::vector<double> values;
  for (const auto& item : range) values.push_back(value(item));
  return values;
}

double depart_delay(const VehicleRecord& v, double end) {
  return v.departure.value_or(end) - v.intended_departure;
}

/// Arrivals per hour while the demand lasts: until the last vehicle wants to depart.
double throughput(const RunReport& report) {
  double last = report.begin;
  for (const VehicleRecord& v : report.vehicles) last = std::max(last, v.intended_departure);
  const auto arrived = std::ranges::count_if(
      report.vehicles, [&](const VehicleRecord& v) { return v.arrival && *v.arrival <= last; });
  return last > report.begin ? double(arrived) * 3600.0 / (last - report.begin) : 0.0;
}

std::vector<double> delays_of(const RunReport& report) {
  return collect(report.vehicles, [&](const VehicleRecord& v) { return delay_of(v, report.end); });
}

Json delay_json(const std::vector<double>& delays) {
  return {{"mean", mean(delays)},
          {"p50", quantile(delays, 0.5)},
          {"p95", quantile(delays, 0.95)},
          {"max", largest(delays)}};
}

/// Of the vehicles that were ever under control, or of the others that departed.
Json delay_by_driver(const RunReport& report, bool coordinated) {
  std::vector<double> delays;
  for (const VehicleRecord& v : report.vehicles) {
    if (v.coordinated == coordinated && v.departure) delays.push_back(delay_of(v, report.end));
  }
  Json delay = delay_json(delays);
  if (delays.empty()) {
    for (auto& value : delay) value = nullptr;
  }
  delay["vehicles"] = delays.size();
  return delay;
}

/// Of emergency vehicles and of buses; nulls where there are none.
Json delay_by_priority(const RunReport& report) {
  Json result = Json::object();
  for (const auto& [kind, name] :
       {std::pair{Priority::Kind::kEmergency, "emergency"}, {Priority::Kind::kBus, "bus"}}) {
    std::vector<double> delays;
    for (const VehicleRecord& v : report.vehicles) {
      if (v.priority == kind && v.departure) delays.push_back(delay_of(v, report.end));
    }
    result[name] = delay_json(delays);
    if (delays.empty()) {
      for (Json& figure : result[name]) figure = nullptr;
    }
    result[name]["vehicles"] = delays.size();
  }
  return result;
}

Json events_json(const std::vector<FaultEvent>& events) {
  Json list = Json::array();
  for (const FaultEvent& e : events) {
    list.push_back(
        {{"frame", e.frame}, {"time_s", e.time}, {"vehicle", e.vehicle}, {"what", e.what}});
  }
  return list;
}

/// The overlaps with a coordinated vehicle, with their frames.
Json contacts_json(const RunReport& report, double step_length) {
  Json list = Json::array();
  for (const AuditEvent& e : report.events) {
    if (e.kind != AuditEventKind::kOverlap || !e.coordinated) continue;
    list.push_back({{"frame", std::lround((e.time - report.begin) / step_length)},
                    {"time_s", e.time},
                    {"what", e.what}});
  }
  return list;
}

Json faults_json(const RunReport& report) {
  const FaultReport& f = *report.faults;
  return {{"simulated", f.simulated},
          {"assumed", f.assumed},
          {"lead_s", f.tolerance.lead * f.step_length},
          {"oldest_report_s", f.tolerance.age},
          {"margin_along_m", f.tolerance.more.along},
          {"margin_across_m", f.tolerance.more.across},
          {"commands", f.figures.commands},
          {"commands_lost", f.figures.commands_lost},
          {"reports", f.figures.reports},
          {"reports_lost", f.figures.reports_lost},
          {"largest_deviation_m", f.figures.largest_deviation},
          {"events", events_json(f.figures.events)},
          {"given_up", events_json(f.given_up)},
          {"contacts", contacts_json(report, f.step_length)}};
}

/// By SUMO's vehicle class: "passenger", "bus", "bicycle", ...
Json delay_by_class(const RunReport& report) {
  std::map<std::string, std::vector<double>> delays;
  for (const VehicleRecord& v : report.vehicles) {
    if (v.departure) delays[v.vehicle_class].push_back(delay_of(v, report.end));
  }
  Json classes = Json::object();
  for (const auto& [name, values] : delays) {
    classes[name] = delay_json(values);
    classes[name]["vehicles"] = values.size();
  }
  return classes;
}

Json audit_json(const AuditFigures& a) {
  return {{"between_steps", a.between_steps},
          {"overlap_pairs", a.overlap_pairs},
          {"overlap_pairs_coordinated", a.overlap_pairs_coordinated},
          {"overlap_vehicle_steps", a.overlap_vehicle_steps},
          {"min_clearance_m", std::isfinite(a.min_clearance) ? Json(a.min_clearance) : Json()},
          {"people_touched", a.people_touched},
          {"min_person_clearance_m",
           std::isfinite(a.min_person_clearance) ? Json(a.min_person_clearance) : Json()},
          {"off_road_steps", a.off_road_steps},
          {"off_road_steps_coordinated", a.off_road_steps_coordinated}};
}

Json people_json(const RunReport& report) {
  return {{"walked", report.people.walked},
          {"touched", report.audit.people_touched_all},
          {"touched_coordinated", report.audit.people_touched},
          {"wait_s", report.people.wait_mean},
          {"wait_p95_s", report.people.wait_p95},
          {"wait_max_s", report.people.wait_max},
          {"greens", report.people_greens}};
}

Json human_faults_json(const HumanFaultFigures& figures) {
  Json faults = Json::array();
  for (const HumanFault& f : figures.faults) {
    faults.push_back({{"time_s", f.begin}, {"vehicle", f.vehicle}, {"kind", to_string(f.kind)}});
  }
  Json overlaps = Json::array();
  std::int64_t avoidable = 0;
  for (const HumanOverlap& o : figures.overlaps) {
    avoidable += o.avoidable ? 1 : 0;
    overlaps.push_back({{"time_s", o.time},
                        {"controlled", o.controlled},
                        {"human", o.human},
                        {"fault", o.fault},
                        {"seen_since_s", o.seen_since},
                        {"braking_could_avoid_it", o.avoidable}});
  }
  return {{"rate", figures.rate},
          {"faults", std::move(faults)},
          {"overlaps", std::move(overlaps)},
          {"avoidable_overlaps", avoidable}};
}

Json zones_json(const RunReport& report) {
  Json zones = Json::array();
  for (const ZoneFigures& zone : report.zones) {
    zones.push_back({{"junctions", zone.junctions}, {"corridors", zone.corridors}});
  }
  return zones;
}

Json left_json(const RunReport& report) {
  Json left = Json::array();
  for (const LeftToTraffic& x : report.left_to_sumo) {
    left.push_back({{"what", x.what}, {"why", x.why}});
  }
  return left;
}

std::string emission_cells(const std::optional<Emissions>& e) {
  return e ? fmt::format("{:.2f},{:.2f},{:.4f}", e->fuel, e->co2, e->nox) : ",,";
}

std::string cell(const std::optional<double>& value) {
  return value ? fmt::format("{:.3f}", *value) : std::string();
}

}  // namespace

double delay_of(const VehicleRecord& v, double end) {
  const double delay = v.arrival.value_or(end) - v.intended_departure - v.free_flow - v.stopped;
  return v.arrival ? delay : std::max(0.0, delay);
}

bool succeeded(const RunReport& report) {
  return report.status != to_string(RunStatus::kFailed) && !report.vehicles.empty() &&
         report.audit.overlap_pairs_coordinated == 0 && report.audit.people_touched == 0 &&
         std::ranges::all_of(report.vehicles,
                             [](const VehicleRecord& v) { return v.arrival.has_value(); });
}

Headline headline(const RunReport& r) {
  const std::vector<double> delays = delays_of(r);
  return {.mean_delay = mean(delays),
          .p95_delay = quantile(delays, 0.95),
          .throughput = throughput(r),
          .completed = std::ranges::count_if(
              r.vehicles, [](const VehicleRecord& v) { return v.arrival.has_value(); }),
          .replan_p95 = quantile(collect(r.replans, [](const Replan& x) { return x.ms; }), 0.95)};
}

namespace {

void add_counts(const RunReport& r, Json& j) {
  const auto completed = std::ranges::count_if(
      r.vehicles, [](const VehicleRecord& v) { return v.arrival.has_value(); });
  const auto departed = std::ranges::count_if(
      r.vehicles, [](const VehicleRecord& v) { return v.departure.has_value(); });
  j["vehicles"] = departed;
  j["never_departed"] = std::int64_t(r.vehicles.size()) - departed;
  j["completed"] = completed;
  j["throughput_veh_h"] = throughput(r);
}

void add_delays(const RunReport& r, Json& j) {
  const auto field_mean = [&](auto value) { return mean(collect(r.vehicles, value)); };
  j["delay_s"] = delay_json(delays_of(r));
  j["penetration"] = r.penetration;
  j["delay_controlled_s"] = delay_by_driver(r, true);
  j["delay_human_s"] = delay_by_driver(r, false);
  j["delay_priority_s"] = delay_by_priority(r);
  if (r.humans) {
    j["greens"] = r.humans->greens;
    j["tube_misses"] = r.humans->tube_misses;
    j["unplanned_passages"] = r.humans->unplanned_passages;
  }
  j["delay_by_class_s"] = delay_by_class(r);
  if (r.human_faults) j["human_faults"] = human_faults_json(*r.human_faults);
  j["people"] = people_json(r);
  j["time_loss_s"] = field_mean([](const VehicleRecord& v) { return v.time_loss; });
  j["depart_delay_s"] = field_mean([&](const VehicleRecord& v) { return depart_delay(v, r.end); });
  j["waiting_time_s"] = field_mean([](const VehicleRecord& v) { return v.waiting_time; });
}

void add_audit(const RunReport& r, Json& j) {
  j["audit"] = audit_json(r.audit);
  j["overlap_pairs_coordinated"] = r.audit.overlap_pairs_coordinated;
  if (r.faults) j["faults"] = faults_json(r);
  j["sumo_collisions"] = r.sumo_collisions;
  j["sumo_warnings"] = r.sumo_warnings;
  j["max_accel"] = r.audit.max_accel;
  j["max_decel"] = r.audit.max_decel;
  j["accel_violations"] = r.audit.accel_violations;
  j["max_lateral_accel"] = r.audit.max_lateral_accel;
  j["max_curvature_ratio"] = r.audit.max_curvature_ratio;
  j["max_speed"] = r.audit.max_speed;
  j["max_jump_m"] = r.audit.max_jump;
  j["hard_brakings_after_handback"] = r.audit.hard_brakings_after_handback;
}

void add_replans(const RunReport& r, Json& j) {
  const std::vector<double> ms = collect(r.replans, [](const Replan& x) { return x.ms; });
  const auto count = [&](auto test) { return std::ranges::count_if(r.replans, test); };
  j["replan_ms"] = {{"p50", quantile(ms, 0.5)},
                    {"p95", quantile(ms, 0.95)},
                    {"p99", quantile(ms, 0.99)},
                    {"max", largest(ms)}};
  j["replans"] = r.replans.size();
  j["fallbacks"] = count([](const Replan& x) { return x.fallback; });
  j["replans_with_stepped_vehicles"] = count([](const Replan& x) { return x.stepped > 0; });
}

}  // namespace

std::string summary_json(const RunReport& r) {
  Json j;
  j["status"] = r.status;
  if (!r.message.empty()) j["message"] = r.message;
  j["controller"] = r.controller;
  add_counts(r, j);
  add_delays(r, j);
  add_measures(r, j);
  add_audit(r, j);
  j["detours"] = r.detours;
  j["lane_swaps"] = r.lane_swaps;
  j["left_to_sumo_sightings"] = r.left_to_sumo_sightings;
  add_replans(r, j);
  if (!r.lots.empty()) j["parking"] = lots_json(r.lots, r.end);
  j["zones"] = zones_json(r);
  j["left_to_sumo"] = left_json(r);
  j["simulated_s"] = r.end - r.begin;
  j["real_time_factor"] = r.wall_time > 0.0 ? (r.end - r.begin) / r.wall_time : 0.0;
  j["sumo_version"] = r.sumo_version;
  j["mvtp_version"] = r.mvtp_version;
  j["seed"] = r.seed;
  j["command"] = r.command;
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string vehicles_csv(const RunReport& r) {
  std::string text =
      "id,type,intended_departure_s,departure_s,arrival_s,free_flow_s,delay_s,time_loss_s,"
      "waiting_time_s,speed_factor,coordinated,min_clearance_m,movement,stops,jerk_m_s3,"
      "longest_wait_s,fuel_ml,co2_g,nox_g\n";
  for (const VehicleRecord& v : r.vehicles) {
    text += fmt::format(
        "{},{},{:.3f},{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.4f},{},{},{},{},{:.3f},{:.1f},{}\n",
        csv_field(v.id), csv_field(v.type), v.intended_departure, cell(v.departure),
        cell(v.arrival), v.free_flow, delay_of(v, r.end), v.time_loss, v.waiting_time,
        v.speed_factor, v.coordinated ? 1 : 0, cell(v.min_clearance), csv_field(v.movement),
        v.driving.stops, v.driving.jerk, v.driving.standing, emission_cells(v.emissions));
  }
  return text;
}

std::string replans_csv(const RunReport& r) {
  std::string text = "time_s,vehicles,newcomers,forecasts,groups,stepped,fallback,cost_s,ms\n";
  for (const Replan& x : r.replans) {
    text += fmt::format("{:.2f},{},{},{},{},{},{},{:.3f},{:.3f}\n", x.time, x.vehicles, x.newcomers,
                        x.forecasts, x.groups, x.stepped, x.fallback ? 1 : 0, x.cost, x.ms);
  }
  return text;
}

std::string events_csv(const RunReport& r) {
  std::string text = "time_s,event,x_m,y_m\n";
  for (const AuditEvent& e : r.events) {
    text +=
        fmt::format("{:.2f},{},{:.3f},{:.3f}\n", e.time, csv_field(e.what), e.where.x, e.where.y);
  }
  return text;
}

}  // namespace mvtp
