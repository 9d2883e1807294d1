#include "coordinator/signals/queue_detector.hpp"

#include <algorithm>
#include <cmath>
#include <ranges>
#include <utility>

namespace mvtp {
namespace {

constexpr double kRange = 150.0;     ///< [m] before a line
constexpr double kAccel = 2.0;       ///< [m/s^2] of a driver who starts
constexpr double kStands = 0.5;      ///< [m/s]
constexpr double kLongStand = 60.0;  ///< [s] of standing, after which more of it weighs more

}  // namespace

QueueDetector::QueueDetector(const Traffic& traffic, const LaneGraph& graph,
                             const SignalHeads& heads, IsControlled is_controlled,
                             const std::vector<int>& lanes)
    : traffic_(traffic), graph_(graph), heads_(heads), is_controlled_(std::move(is_controlled)) {
  for (const int lane : lanes) stretches_[lane] = stretches_to(lane);
  for (const auto& [lane, stretches] : stretches_) {
    for (const Stretch& stretch : stretches) vehicles_[stretch.lane];
  }
}

/// The lane itself first, then those that lead to it.
std::vector<QueueDetector::Stretch> QueueDetector::stretches_to(int lane) const {
  std::vector<Stretch> stretches = {{lane, 0.0}};
  const auto add = [&](int l, double to_line) {
    const bool known = std::ranges::count(stretches, l, &Stretch::lane) > 0;
    if (!known && to_line < kRange) stretches.push_back({l, to_line});
  };
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    const Stretch stretch = stretches[i];
    for (const int k : graph_.links_to(stretch.lane)) {
      const LaneGraph::Link& link = graph_.link(k);
      if (link.to != stretch.lane) continue;
      double to_line = stretch.to_line + graph_.lane(stretch.lane).length;
      for (const int via : std::views::reverse(link.via)) {
        add(via, to_line);
        to_line += graph_.lane(via).length;
      }
      add(link.from, to_line);
    }
  }
  return stretches;
}

void QueueDetector::look() {
  for (auto& [lane, vehicles] : vehicles_) vehicles.clear();
  std::map<std::string, double> stood_now;
  for (const VehicleState& v : traffic_.vehicles()) {
    const auto there = vehicles_.find(graph_.find_lane(v.lane));
    if (there == vehicles_.end() || v.halted_by_stop) continue;
    there->second.push_back(&v);
    const auto known = stood_.find(v.id);
    double& stood = stood_now[v.id];
    if (known != stood_.end()) stood = known->second;
    if (v.speed < kStands) stood += traffic_.time() - looked_;
  }
  stood_ = std::move(stood_now);
  looked_ = traffic_.time();
}

/// Who has stood for long loses more by standing on: else a few would wait for ever beside a
/// stream of others.
double QueueDetector::weight_of(const VehicleState& v) const {
  return std::max(1.0, stood_.at(v.id) / kLongStand);
}

/// The connection by which it goes on from a lane ahead, or its own; LaneGraph::kNone: it does not
/// come to that lane, or changes lanes first.
int QueueDetector::link_of(const VehicleState& v, int lane) const {
  const std::span<const std::string> route = traffic_.route_edges(v.id);
  const auto here = std::ranges::find(route, graph_.lane(lane).edge);
  if (here == route.end() || here + 1 == route.end()) return LaneGraph::kNone;
  const std::string& next = *(here + 1);
  for (const int k : graph_.links_from(lane)) {
    if (graph_.lane(graph_.link(k).to).edge == next && heads_.owns(k)) return k;
  }
  return LaneGraph::kNone;
}

/// Those that come to the line of a lane, the first first.
std::vector<QueueDetector::Seen> QueueDetector::seen_before(int lane) const {
  std::vector<Seen> all;
  for (const Stretch& stretch : stretches_.at(lane)) {
    for (const VehicleState* v : vehicles_.at(stretch.lane)) {
      const double to_end = graph_.lane(stretch.lane).length - v->lane_position;
      const Seen seen{v, stretch.to_line + std::max(0.0, to_end), link_of(*v, lane)};
      const bool comes = stretch.lane == lane || seen.link != LaneGraph::kNone;
      if (comes && seen.to_line < kRange) all.push_back(seen);
    }
  }
  std::ranges::stable_sort(all, {}, &Seen::to_line);
  return all;
}

Queues QueueDetector::queues(const std::vector<int>& lanes) const {
  Queues queues;
  std::set<const VehicleState*> counted;
  for (const int lane : lanes) {
    std::vector<QueuedVehicle>& queue = queues.emplace_back();
    std::size_t needed = 0;
    for (const Seen& seen : seen_before(lane)) {
      if (seen.link == LaneGraph::kNone) break;  // it changes lanes first
      if (!counted.insert(seen.vehicle).second) continue;
      const bool stands = seen.vehicle->speed < kStands;
      queue.push_back({.link = seen.link,
                       .arrival = arrival(*seen.vehicle, lane, seen.to_line),
                       .stands = stands,
                       .needs_green = !is_controlled_(seen.vehicle->id),
                       .weight = weight_of(*seen.vehicle)});
      if (stands || queue.back().needs_green) needed = queue.size();
    }
    queue.resize(needed);
  }
  return queues;
}

/// [s] until it is at its line if it speeds up as it can.
double QueueDetector::arrival(const VehicleState& v, int lane, double to_line) const {
  const double most = std::max(v.speed, graph_.lane(lane).speed_limit * v.speed_factor);
  const double to_speed_up = (most * most - v.speed * v.speed) / (2.0 * kAccel);
  if (to_line < to_speed_up)
    return (std::sqrt(v.speed * v.speed + 2.0 * kAccel * to_line) - v.speed) / kAccel;
  return (most - v.speed) / kAccel + (to_line - to_speed_up) / most;
}

}  // namespace mvtp
