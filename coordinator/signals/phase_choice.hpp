#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/signals/queue_detector.hpp"
#include "coordinator/signals/signal_phases.hpp"

namespace mvtp {

/// Which movements may get green now, at signals whose changes cost time. As long as no two who
/// come need lights that cross, each light goes alone. Where they do, those of one phase of the
/// signal go: it gives way to another one as soon as those who are seen lose less in all than if it
/// went on [rolling horizon, as in OPAC and SURTRAC], and ends when nobody comes who needs it.
class PhaseChoice {
 public:
  using IsControlled = QueueDetector::IsControlled;

  PhaseChoice(Traffic& traffic, const LaneGraph& graph, const SignalHeads& heads,
              IsControlled is_controlled);

  [[nodiscard]] const SignalPhases& phases() const { return phases_; }
  /// A decision begins.
  void decide();
  /// May this light turn green? Always where no phase is on.
  [[nodiscard]] bool allows(int link) const;
  /// Is a phase on of which it is one?
  [[nodiscard]] bool is_on(int link) const;
  /// Does whoever has this green give way to others, in the phase that is on?
  [[nodiscard]] bool yields(int link) const;
  /// The connections of the phase that is on at the signal of this one; none: each goes alone.
  [[nodiscard]] const std::set<int>& beside(int link) const;
  /// May two lights that cross be green together now? Not while one who has to yield has a green
  /// that does not say so.
  [[nodiscard]] bool go_together(int link, int other) const;
  /// Until when people keep this light red [s]: not those to whom one with it gives way.
  [[nodiscard]] double barred_until(int link) const;
  /// Do these two not exclude each other's green? Some who drive there may.
  [[nodiscard]] bool may_be_green_together(int link, int other) const;

 private:
  struct Choice {
    int phase = 0;
    double since = -1e300;  ///< [s] when it was chosen
    bool alone = true;      ///< each light goes alone: no phase is on
  };
  void decide(int signal);
  void start(int signal, const Queues& queues);
  void go_on(int signal, const Queues& queues);
  [[nodiscard]] const GreenPhase* present(int link) const;
  [[nodiscard]] bool is_contested(const Queues& queues) const;
  [[nodiscard]] bool is_dark(const GreenPhase& phase) const;
  [[nodiscard]] double can_begin(int signal, const GreenPhase& phase) const;
  [[nodiscard]] QueuePhases model_of(int signal, const Choice& choice) const;
  [[nodiscard]] double yellow_time(int signal) const;
  [[nodiscard]] double change_time(int signal) const;

  Traffic& traffic_;
  const LaneGraph& graph_;
  const SignalHeads& heads_;
  SignalPhases phases_;
  std::vector<Choice> choices_;          ///< by signal
  std::vector<std::vector<int>> lanes_;  ///< that come to it, by signal
  std::optional<QueueDetector> detector_;
};

}  // namespace mvtp
