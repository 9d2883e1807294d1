#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/queue_model.hpp"
#include "coordinator/signal_phases.hpp"

namespace mvtp {

/// Which movements may get green now, at signals whose changes cost time: those of one phase of
/// each signal. A phase gives way to another one as soon as those who are seen lose less in all
/// than if it went on [rolling horizon, as in OPAC and SURTRAC], and to red for all when nobody
/// comes who needs it: from there any phase begins at once.
class PhaseChoice {
 public:
  /// Is this vehicle under control? It needs no green, but those behind it do.
  using IsControlled = std::function<bool(const std::string&)>;

  PhaseChoice(Traffic& traffic, const LaneGraph& graph, const SignalHeads& heads,
              IsControlled is_controlled);

  [[nodiscard]] const SignalPhases& phases() const { return phases_; }
  /// A decision begins.
  void decide();
  /// May this light turn green? Always where a signal has no phases.
  [[nodiscard]] bool allows(int link) const;
  /// Does whoever has this green give way to others, in the phase that is on?
  [[nodiscard]] bool yields(int link) const;
  /// The connections of the phase that is on at the signal of this one.
  [[nodiscard]] const std::set<int>& beside(int link) const;
  /// Lights that cross this one and may be green beside it now.
  [[nodiscard]] bool go_together(int link, int other) const {
    return allows(link) && allows(other) && phases_.permits(link, other);
  }

 private:
  struct Choice {
    int phase = 0;
    double since = -1e300;  ///< [s] when it was chosen
    bool rests = true;      ///< nobody needs it: all lights are red, or about to be, and
    double over = -1e300;   ///< [s] have been since then
  };
  void decide(int signal);
  void start(int signal, const Queues& queues);
  void go_on(int signal, const Queues& queues);
  [[nodiscard]] const GreenPhase& present(int signal) const;
  [[nodiscard]] Queues queues_of(int signal) const;
  [[nodiscard]] std::vector<QueuedVehicle> queue_on(int lane) const;
  [[nodiscard]] int link_of(const VehicleState& vehicle, int lane) const;
  [[nodiscard]] double arrival(const VehicleState& vehicle, int lane) const;
  [[nodiscard]] QueuePhases model_of(int signal, const Choice& choice) const;
  [[nodiscard]] double change_time(int signal) const;

  Traffic& traffic_;
  const LaneGraph& graph_;
  const SignalHeads& heads_;
  IsControlled is_controlled_;
  SignalPhases phases_;
  std::vector<Choice> choices_;          ///< by signal
  std::vector<std::vector<int>> lanes_;  ///< that come to it, by signal
};

}  // namespace mvtp
