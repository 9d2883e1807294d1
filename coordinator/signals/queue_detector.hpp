#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "coordinator/signals/queue_model.hpp"
#include "coordinator/signals/signal_heads.hpp"

namespace mvtp {

/// Who comes to the lines of signals, as a detector over the last 150 m before each would see it:
/// along its lane, and before that along those that lead there, over whatever junctions.
class QueueDetector {
 public:
  /// Is this vehicle under control? It needs no green, but those behind it do.
  using IsControlled = std::function<bool(const std::string&)>;

  /// @param traffic, graph, heads  must outlive it.
  /// @param lanes  that end at a signal.
  QueueDetector(const Traffic& traffic, const LaneGraph& graph, const SignalHeads& heads,
                IsControlled is_controlled, const std::vector<int>& lanes);

  /// A decision begins.
  void look();
  /// Those before the lines of these lanes, the first first, up to the last who needs a green: a
  /// vehicle under control does when it stands. Nobody is in two queues.
  [[nodiscard]] Queues queues(const std::vector<int>& lanes) const;

 private:
  /// A lane that leads to a line.
  struct Stretch {
    int lane = LaneGraph::kNone;
    double to_line = 0.0;  ///< [m] from its end
  };
  struct Seen {
    const VehicleState* vehicle = nullptr;
    double to_line = 0.0;  ///< [m]
    int link = LaneGraph::kNone;
  };

  [[nodiscard]] std::vector<Stretch> stretches_to(int lane) const;
  [[nodiscard]] std::vector<Seen> seen_before(int lane) const;
  [[nodiscard]] int link_of(const VehicleState& vehicle, int lane) const;
  [[nodiscard]] double weight_of(const VehicleState& vehicle) const;
  [[nodiscard]] double arrival(const VehicleState& vehicle, int lane, double to_line) const;

  const Traffic& traffic_;
  const LaneGraph& graph_;
  const SignalHeads& heads_;
  IsControlled is_controlled_;
  std::map<int, std::vector<Stretch>> stretches_;             ///< by lane
  std::map<int, std::vector<const VehicleState*>> vehicles_;  ///< by the lane that they are on
  std::map<std::string, double> stood_;                       ///< [s] so far
  double looked_ = 0.0;                                       ///< [s] when
};

}  // namespace mvtp
