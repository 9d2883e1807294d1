#pragma once

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/signals/signal_heads.hpp"

namespace mvtp {

/// Connections of one signal that have green together.
struct GreenPhase {
  std::set<int> links;
  std::set<int> yielding;  ///< those of them that give way to others of the phase (SUMO's 'g')
};

/// The green phases of a signal that is ours.
struct PhasedSignal {
  std::string id;
  std::vector<GreenPhase> phases;  ///< in the order of its program, each once
};

/// Which movements may have green together: those that do in a phase of the signal's own program.
/// Of movements that cross mostly one yields there. Where none does, as of two who turn side by
/// side, both have green, but not everybody has room beside everybody.
class SignalPhases {
 public:
  SignalPhases(const Traffic& traffic, const LaneGraph& graph, const SignalHeads& heads);

  [[nodiscard]] const std::vector<PhasedSignal>& signals() const { return signals_; }
  /// The number of the signal that a connection obeys; LaneGraph::kNone: one without phases.
  [[nodiscard]] int signal_of(int link) const { return signal_of_[std::size_t(link)]; }
  /// Does somebody on the first connection give way to those with the other light, of a connection
  /// or a crossing, if both have green?
  [[nodiscard]] bool yields_to(int link, int other) const {
    return yields_.contains({link, other});
  }
  /// May two connections that cross have green together, as one of them yields?
  [[nodiscard]] bool permits(int link, int other) const {
    return yields_to(link, other) || yields_to(other, link);
  }
  /// Have two connections that come near each other green together, and neither yields?
  [[nodiscard]] bool protects_both(int link, int other) const {
    return protected_.contains(std::minmax(link, other));
  }

 private:
  [[nodiscard]] std::vector<GreenPhase> read_program(const Traffic& traffic, const LaneGraph& graph,
                                                     const std::string& signal,
                                                     const std::vector<int>& links) const;
  void find_who_yields(const GreenPhase& phase, const SignalHeads& heads);
  void find_who_yields_to_people(const Traffic& traffic, const LaneGraph& graph,
                                 const SignalHeads& heads, const std::vector<int>& links);
  void find_protected(const GreenPhase& phase, const SignalHeads& heads);

  std::vector<PhasedSignal> signals_;
  std::vector<int> signal_of_;
  std::set<std::pair<int, int>> yields_;
  std::set<std::pair<int, int>> protected_;
};

}  // namespace mvtp
