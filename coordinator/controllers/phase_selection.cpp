#include "coordinator/controllers/phase_selection.hpp"

#include <algorithm>

namespace mvtp {
namespace {

constexpr double kTimeTolerance = 1e-6;  ///< [s]
constexpr double kYellow = 3.0;          ///< [s] where a program has none

bool is_green(char light) { return light == 'G' || light == 'g'; }
bool has_yellow(const std::string& lights) {
  return lights.find_first_of("yu") != std::string::npos;
}
bool has_green(const std::string& lights) { return std::ranges::any_of(lights, is_green); }

}  // namespace

void LaneCounts::count(const Traffic& traffic) {
  on_lane_.clear();
  on_edge_.clear();
  heading_.clear();
  for (const VehicleState& v : traffic.vehicles()) {
    const auto found = traffic.network().lanes.find(v.lane);
    if (found == traffic.network().lanes.end() || found->second.internal) continue;
    const Lane& lane = found->second;
    if (v.lane_position <= reach_) ++on_edge_[lane.edge];
    if (lane.length - v.lane_position > reach_) continue;
    ++on_lane_[v.lane];
    const std::span<const std::string> route = traffic.route_edges(v.id);
    if (route.size() > 1) ++heading_[{v.lane, route[1]}];
  }
}

int LaneCounts::heading(const std::string& lane, const std::string& edge) const {
  const auto found = heading_.find({lane, edge});
  return found == heading_.end() ? 0 : found->second;
}

PhaseSelection::PhaseSelection(Traffic& traffic, const std::vector<std::string>& signals,
                               double reach, Worth worth)
    : traffic_(traffic), worth_(std::move(worth)), counts_(reach) {
  const RoadNetwork& network = traffic.network();
  std::map<std::string, std::vector<SignalLink>> links;
  std::map<std::string, int> movements_on;
  for (const auto& [id, junction] : network.junctions) {
    for (const Connection& c : junction.connections)
      ++movements_on[network.lanes.at(c.from_lane).edge];
  }
  for (const auto& [id, junction] : network.junctions) {
    for (const Connection& c : junction.connections) {
      const std::string& to = network.lanes.at(c.to_lane).edge;
      links[c.signal].push_back(
          {.light = c.signal_index,
           .from_lane = c.from_lane,
           .from_edge = network.lanes.at(c.from_lane).edge,
           .to_edge = to,
           .movements_on = movements_on.contains(to) ? movements_on.at(to) : 0});
    }
  }
  signals_.reserve(signals.size());  // links are pointed to
  for (const std::string& id : signals) {
    Signal& signal = signals_.emplace_back();
    signal.id = id;
    signal.links = links[id];
    read_program(signal);
    signal.next_decision = traffic.time();
    if (signal.greens.empty()) signals_.pop_back();  // nothing to choose from: it goes on as it is
  }
}

/// The greens of a signal's program, and what comes behind each.
void PhaseSelection::read_program(Signal& signal) const {
  const std::vector<SignalPhase> phases = traffic_.signal_phases(signal.id);
  for (std::size_t p = 0; p < phases.size(); ++p) {
    const std::string& lights = phases[p].lights;
    if (has_yellow(lights) || !has_green(lights)) continue;
    Green green{.lights = lights};
    for (std::size_t n = 1; n < phases.size(); ++n) {
      const SignalPhase& next = phases[(p + n) % phases.size()];
      const bool yellow = has_yellow(next.lights);
      if (!yellow && has_green(next.lights)) break;
      (yellow ? green.yellow : green.all_red) += next.duration;
    }
    if (green.yellow <= 0.0) green.yellow = kYellow;
    for (const SignalLink& link : signal.links) {
      const auto light = std::size_t(link.light);
      if (light < lights.size() && is_green(lights[light])) green.links.push_back(&link);
    }
    const bool known = std::ranges::any_of(
        signal.greens, [&](const Green& other) { return other.lights == lights; });
    if (!known) signal.greens.push_back(std::move(green));
  }
}

void PhaseSelection::decide() {
  const double now = traffic_.time();
  const auto due = [&](const Signal& s) { return now >= s.next_decision - kTimeTolerance; };
  if (std::ranges::any_of(signals_, due)) counts_.count(traffic_);
  for (Signal& signal : signals_) {
    if (due(signal)) choose(signal);
    traffic_.show_all(signal.id, lights_now(signal));
  }
}

/// The green that is worth most; of two that are worth the same the one that is shown, else the
/// earlier one of the program.
void PhaseSelection::choose(Signal& signal) {
  std::size_t best = signal.shown;
  double most = worth_(signal.greens[best].links, counts_);
  for (std::size_t g = 0; g < signal.greens.size(); ++g) {
    const double worth = worth_(signal.greens[g].links, counts_);
    if (worth <= most) continue;
    best = g;
    most = worth;
  }
  signal.before = signal.shown;
  signal.shown = best;
  signal.change_began = traffic_.time();
  signal.next_decision += kDecision;
}

std::string PhaseSelection::lights_now(const Signal& signal) const {
  const Green& next = signal.greens[signal.shown];
  const Green& before = signal.greens[signal.before];
  const double since = traffic_.time() - signal.change_began;
  const bool changes = signal.shown != signal.before;
  if (!changes || since >= before.yellow + before.all_red - kTimeTolerance) return next.lights;
  std::string lights = before.lights;
  const bool yellow = since < before.yellow - kTimeTolerance;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (!is_green(before.lights[i]) || is_green(next.lights[i])) continue;
    lights[i] = char(yellow ? Light::kYellow : Light::kRed);
  }
  return lights;
}

}  // namespace mvtp
