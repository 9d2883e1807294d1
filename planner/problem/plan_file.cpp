#include "planner/problem/plan_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <unordered_map>

#include "planner/problem/document.hpp"
#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "planner/problem/vehicle_file.hpp"
#include "planner/problem/yaml_text.hpp"

namespace mvtp {
namespace {

constexpr std::size_t kMaxBytes = 2'000'000'000;
constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();

double signed_yaw(double yaw, YawSense sense) { return sense == YawSense::kClockwise ? -yaw : yaw; }

YawSense read_sense(const Value& value) {
  const std::string text = value.text();
  if (text == "ccw") return YawSense::kCounterClockwise;
  if (text == "cw") return YawSense::kClockwise;
  throw InputError(value.where(), fmt::format("is \"{}\"; choose ccw or cw", text));
}

/// The statistics of a plan. Those of peers mean other things by the same keys, so that all but
/// `dt` and `yaw` are for display only.
Statistics read_statistics(const Value& value, double default_dt) {
  Statistics result;
  result.dt = default_dt;
  const auto number = [&](std::string_view key, double& target, std::string_view unit) {
    if (const auto entry = value.find(key)) target = entry->number(unit);
  };
  const auto text = [&](std::string_view key, std::string& target) {
    if (const auto entry = value.find(key)) target = entry->text();
  };
  text("status", result.status);
  text("algorithm", result.algorithm);
  text("pbcr", result.pbcr);
  text("version", result.version);
  text("reason", result.reason);
  number("cost", result.cost, "s");
  number("makespan", result.makespan, "s");
  number("flowtime", result.flowtime, "s");
  number("runtime", result.runtime, "s");
  number("lower_bound", result.lower_bound, "s");
  if (const auto list = value.find("initial_overlaps")) {
    list->require_list(0, std::numeric_limits<std::uint32_t>::max(), "[start of agent0 in ...]");
    for (std::size_t i = 0; i < list->size(); ++i) {
      result.initial_overlaps.push_back((*list)[i].text());
    }
  }
  if (const auto entry = value.find("solo_makespan")) result.solo_makespan = entry->number("s");
  if (const auto entry = value.find("first_solution")) result.first_solution = entry->number("s");
  if (const auto entry = value.find("makespan_steps")) result.makespan_steps = entry->count();
  if (const auto entry = value.find("seed")) result.seed = entry->count();
  if (const auto entry = value.find("dt")) result.dt = entry->positive("s");
  return result;
}

double optional_number(const Value& waypoint, std::string_view key, std::string_view unit) {
  const std::optional<Value> entry = waypoint.find(key);
  return entry ? entry->number(unit) : kNotGiven;
}

Trajectory read_trajectory(const Value& list, YawSense sense) {
  list.require_list(1, std::numeric_limits<std::uint32_t>::max(),
                    "[{x: 1.0, y: 2.0, yaw: 0.0, t: 0}]");
  std::vector<Waypoint> waypoints;
  waypoints.reserve(list.size());
  for (std::size_t step = 0; step < list.size(); ++step) {
    const Value entry = list[step];
    entry.require_map("{x: 1.0, y: 2.0, yaw: 0.0, t: 0}");
    if (const auto t = entry.find("t"); t && t->number("steps") != static_cast<double>(step)) {
      throw InputError(t->where(), fmt::format("is {} where step {} should stand; list every step "
                                               "once, from 0 on",
                                               t->text(), step));
    }
    Waypoint waypoint{{entry.at("x").number("m"), entry.at("y").number("m"),
                       signed_yaw(entry.at("yaw").number("rad"), sense)},
                      optional_number(entry, "v", "m/s"),
                      signed_yaw(optional_number(entry, "phi", "rad"), sense)};
    if (step == 0) waypoint.v = waypoint.phi = 0.0;  // nothing was driven yet
    waypoints.push_back(waypoint);
  }
  return Trajectory(std::move(waypoints));
}

/// `vehicle`: that of all; `vehicles`: one for each name of the schedule.
std::vector<Vehicle> read_vehicles(const Value& root, const std::vector<std::string>& names) {
  const VehiclePreset standard = vehicle_preset("escot").value();
  if (const auto common = root.find("vehicle")) {
    return std::vector(names.size(), read_vehicle(*common, standard).vehicle);
  }
  std::vector<Vehicle> vehicles;
  if (const auto each = root.find("vehicles")) {
    each->require_map("{agent0: {preset: escot}}");
    for (const std::string& name : names) {
      vehicles.push_back(read_vehicle(each->at(name), standard).vehicle);
    }
  }
  return vehicles;
}

std::string vehicles_text(const Plan& plan) {
  if (plan.vehicles.empty()) return {};
  const bool is_mixed =
      std::ranges::adjacent_find(plan.vehicles, std::ranges::not_equal_to{}) != plan.vehicles.end();
  if (!is_mixed) return fmt::format("vehicle: {}\n", vehicle_text(plan.vehicles.front()));
  std::string text = "vehicles:\n";
  for (std::size_t i = 0; i < plan.vehicles.size(); ++i) {
    text +=
        fmt::format("  {}: {}\n", yaml_string(plan.names.at(i)), vehicle_text(plan.vehicles[i]));
  }
  return text;
}

Plan read_schedule(const Value& root, const PlanReadOptions& options) {
  Plan plan;
  YawSense sense = options.yaw;
  plan.statistics.dt = options.dt;
  if (const auto statistics = root.find("statistics")) {
    statistics->require_map("{cost: 12.0, makespan: 7.0}");
    plan.statistics = read_statistics(*statistics, options.dt);
    if (const auto yaw = statistics->find("yaw")) sense = read_sense(*yaw);
  }
  const Value schedule = root.at("schedule");
  schedule.require_map("{agent0: [{x: 1.0, y: 2.0, yaw: 0.0, t: 0}]}");
  for (std::size_t i = 0; i < schedule.size(); ++i) {
    plan.names.emplace_back(schedule[i].key());
    plan.trajectories.push_back(read_trajectory(schedule[i], sense));
  }
  plan.vehicles = read_vehicles(root, plan.names);
  return plan;
}

/// The JSON result of CarLikePlanning: paths[agent][step] = [x, y, yaw].
Plan read_guo_yu(const Value& root, const PlanReadOptions& options) {
  Plan plan;
  plan.statistics.dt = options.dt;
  const Value paths = root.at("paths");
  paths.require_list(1, std::numeric_limits<std::uint32_t>::max(), "[[[x, y, yaw]]]");
  for (std::size_t i = 0; i < paths.size(); ++i) {
    paths[i].require_list(1, std::numeric_limits<std::uint32_t>::max(), "[[x, y, yaw]]");
    std::vector<Waypoint> waypoints;
    for (std::size_t step = 0; step < paths[i].size(); ++step) {
      const Value entry = paths[i][step];
      entry.require_list(3, 3, "[x, y, yaw]");
      const double motion = step == 0 ? 0.0 : kNotGiven;
      waypoints.push_back({{entry[0].number("m"), entry[1].number("m"),
                            signed_yaw(entry[2].number("rad"), options.yaw)},
                           motion,
                           motion});
    }
    plan.names.push_back(fmt::format("agent{}", i));
    plan.trajectories.emplace_back(std::move(waypoints));
  }
  return plan;
}

std::string statistics_text(const Statistics& statistics, YawSense yaw) {
  std::string text = "statistics:\n";
  const auto line = [&](std::string_view key, const std::string& value) {
    text += fmt::format("  {}: {}\n", key, value);
  };
  line("status", yaml_string(statistics.status));
  line("algorithm", yaml_string(statistics.algorithm));
  if (!statistics.pbcr.empty()) line("pbcr", yaml_string(statistics.pbcr));
  line("cost", yaml_number(statistics.cost));
  line("makespan", yaml_number(statistics.makespan));
  line("flowtime", yaml_number(statistics.flowtime));
  line("runtime", yaml_number(statistics.runtime));
  if (statistics.first_solution) line("first_solution", yaml_number(*statistics.first_solution));
  line("makespan_steps", fmt::to_string(statistics.makespan_steps));
  line("lower_bound", yaml_number(statistics.lower_bound));
  if (statistics.solo_makespan) line("solo_makespan", yaml_number(*statistics.solo_makespan));
  line("seed", fmt::to_string(statistics.seed));
  line("dt", yaml_number(statistics.dt));
  line("version", yaml_string(statistics.version));
  if (!statistics.reason.empty()) line("reason", yaml_string(statistics.reason));
  if (yaw == YawSense::kClockwise) line("yaw", "cw");
  if (!statistics.initial_overlaps.empty()) text += "  initial_overlaps:\n";
  for (const std::string& overlap : statistics.initial_overlaps) {
    text += fmt::format("    - {}\n", yaml_string(overlap));
  }
  return text;
}

void append_waypoint(std::string& text, const Waypoint& waypoint, std::size_t step, YawSense yaw) {
  fmt::format_to(std::back_inserter(text), "    - {{x: {}, y: {}, yaw: {}, t: {}",
                 yaml_number(waypoint.pose.x), yaml_number(waypoint.pose.y),
                 yaml_number(signed_yaw(waypoint.pose.theta, yaw)), step);
  if (step > 0 && !std::isnan(waypoint.v) && !std::isnan(waypoint.phi)) {
    fmt::format_to(std::back_inserter(text), ", v: {}, phi: {}", yaml_number(waypoint.v),
                   yaml_number(signed_yaw(waypoint.phi, yaw)));
  }
  text += "}\n";
}

}  // namespace

Plan read_plan(const std::string& path, const PlanReadOptions& options) {
  return parse_plan(path, read_text_file(path, kMaxBytes), options);
}

Plan parse_plan(const std::string& name, const std::string& text, const PlanReadOptions& options) {
  const Document document = Document::parse(name, text, {"schedule", "paths"}, "a plan file");
  const Value root = document.root();
  root.require_map("{schedule: ...}");
  return root.find("paths") ? read_guo_yu(root, options) : read_schedule(root, options);
}

bool take_vehicles(const Plan& plan, Instance& instance) {
  std::unordered_map<std::string_view, const Vehicle*> recorded;
  for (std::size_t i = 0; i < plan.vehicles.size(); ++i) {
    recorded.emplace(plan.names[i], &plan.vehicles[i]);
  }
  bool changes = false;
  for (Agent& agent : instance.agents) {
    const auto found = recorded.find(agent.name);
    if (found == recorded.end() || agent.vehicle == *found->second) continue;
    agent.vehicle = *found->second;
    changes = true;
  }
  return changes;
}

std::string plan_text(const Plan& plan, YawSense yaw) {
  std::string text = statistics_text(plan.statistics, yaw) + vehicles_text(plan);
  text += plan.trajectories.empty() ? "schedule: {}\n" : "schedule:\n";
  for (std::size_t i = 0; i < plan.trajectories.size(); ++i) {
    text += fmt::format("  {}:\n", yaml_string(plan.names.at(i)));
    const std::vector<Waypoint>& waypoints = plan.trajectories[i].waypoints();
    for (std::size_t step = 0; step < waypoints.size(); ++step) {
      append_waypoint(text, waypoints[step], step, yaw);
    }
  }
  return text;
}

void write_plan(const Plan& plan, const std::string& path, YawSense yaw) {
  write_text_file(path, plan_text(plan, yaw));
}

}  // namespace mvtp
