#include "coordinator/signals/signal_phases.hpp"

#include <algorithm>
#include <map>
#include <string_view>

namespace mvtp {

SignalPhases::SignalPhases(const Traffic& traffic, const LaneGraph& graph,
                           const SignalHeads& heads) {
  signal_of_.assign(std::size_t(graph.links()), LaneGraph::kNone);
  std::map<std::string, std::vector<int>> links;
  for (int k = 0; k < graph.links(); ++k) {
    if (heads.owns(k)) links[graph.link(k).signal].push_back(k);
  }
  for (const auto& [signal, own] : links) {
    std::vector<GreenPhase> phases = read_program(traffic, graph, signal, own);
    if (phases.empty()) continue;
    for (const int k : own) signal_of_[std::size_t(k)] = int(signals_.size());
    find_who_yields_to_people(traffic, graph, heads, own);
    for (const GreenPhase& phase : phases) {
      find_who_yields(phase, heads);
      find_protected(phase, heads);
    }
    signals_.push_back({signal, std::move(phases)});
  }
}

std::vector<GreenPhase> SignalPhases::read_program(const Traffic& traffic, const LaneGraph& graph,
                                                   const std::string& signal,
                                                   const std::vector<int>& links) const {
  std::vector<GreenPhase> phases;
  for (const SignalPhase& phase : traffic.signal_phases(signal)) {
    if (phase.lights.find_first_of("yu") != std::string::npos) continue;
    GreenPhase green;
    for (const int k : links) {
      const auto index = std::size_t(graph.link(k).signal_index);
      const char light = index < phase.lights.size() ? phase.lights[index] : 'r';
      if (light == 'G' || light == 'g') green.links.insert(k);
      if (light == 'g') green.yielding.insert(k);
    }
    const bool known = std::ranges::any_of(
        phases, [&](const GreenPhase& other) { return other.links == green.links; });
    if (!green.links.empty() && !known) phases.push_back(std::move(green));
  }
  return phases;
}

void SignalPhases::find_who_yields(const GreenPhase& phase, const SignalHeads& heads) {
  for (const int k : phase.yielding) {
    for (const int other : phase.links) {
      if (heads.cross(k, other)) yields_.insert({k, other});
    }
  }
}

/// Those who turn over a crossing while people there have green, too.
void SignalPhases::find_who_yields_to_people(const Traffic& traffic, const LaneGraph& graph,
                                             const SignalHeads& heads,
                                             const std::vector<int>& links) {
  const std::string& signal = graph.link(links.front()).signal;
  for (const SignalPhase& phase : traffic.signal_phases(signal)) {
    const auto shows = [&phase](int index, std::string_view lights) {
      return std::size_t(index) < phase.lights.size() &&
             lights.find(phase.lights[std::size_t(index)]) != std::string_view::npos;
    };
    for (int c = 0; c < graph.crossings(); ++c) {
      const PedestrianCrossing& crossing = *graph.crossing(c).crossing;
      const bool walks =
          crossing.signal == signal && !crossing.lights.empty() &&
          std::ranges::all_of(crossing.lights, [&](int i) { return shows(i, "Gg"); });
      if (!walks) continue;
      const int light = heads.light_of_crossing(c);
      for (const int k : links) {
        const bool turns = shows(graph.link(k).signal_index, "g") && heads.cross(k, light);
        if (turns) yields_.insert({k, light});
      }
    }
  }
}

void SignalPhases::find_protected(const GreenPhase& phase, const SignalHeads& heads) {
  for (const int k : phase.links) {
    for (const int other : phase.links) {
      const bool is_protected = !phase.yielding.contains(k) && !phase.yielding.contains(other);
      if (k < other && is_protected && heads.cross(k, other)) protected_.insert({k, other});
    }
  }
}

}  // namespace mvtp
