#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "coordinator/network/lane_graph.hpp"
#include "coordinator/traffic.hpp"

namespace mvtp {

/// Drivers who stand at the end of a lane that does not lead where they mean to go.
///
/// Two who wait for each other's lane stand there for good, and all behind them: SUMO only knows to
/// teleport them, which no run here does. After kGivesUp such two change lanes at once; whoever has
/// no such partner drives on where its lane leads, and finds another path from there.
class WrongLanes {
 public:
  static constexpr double kGivesUp = 60.0;  ///< [s]

  using IsControlled = std::function<bool(const std::string&)>;

  /// @param traffic, graph  must outlive it.
  WrongLanes(Traffic& traffic, const LaneGraph& graph, IsControlled is_controlled);

  /// To be called at each decision.
  void look();
  /// Drivers who took another path so far,
  [[nodiscard]] int detours() const { return detours_; }
  /// and pairs of them who changed lanes at once.
  [[nodiscard]] int swaps() const { return swaps_; }

 private:
  /// One of those drivers.
  struct Waiting {
    const VehicleState* state = nullptr;
    int lane = 0;
    int next = 0;  ///< the edge where it means to go
  };
  /// What is known of one who waits.
  struct Wait {
    double since = 0.0;    ///< [s] when it came to stand there
    bool no_path = false;  ///< from where its lane leads
  };

  [[nodiscard]] std::vector<Waiting> waiting() const;
  [[nodiscard]] bool stands_at_end(const VehicleState& v, int lane) const;
  [[nodiscard]] int next_edge(const VehicleState& v, int lane) const;
  [[nodiscard]] bool suit_each_other(const Waiting& a, const Waiting& b) const;

  Traffic& traffic_;
  const LaneGraph& graph_;
  IsControlled is_controlled_;
  std::map<std::string, Wait> waits_;  ///< of each of those drivers
  int detours_ = 0;
  int swaps_ = 0;
};

}  // namespace mvtp
