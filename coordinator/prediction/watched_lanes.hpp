#pragma once

#include <vector>

#include "coordinator/corridor/corridor.hpp"
#include "coordinator/network/lanes_beside.hpp"

namespace mvtp {

/// The lanes on which drivers matter to those under control.
class WatchedLanes {
 public:
  /// At first those of coordinated junctions, and those from which they are approached.
  /// @param graph  outlives this.
  WatchedLanes(const LaneGraph& graph, const CourseFinder& finder);

  [[nodiscard]] bool contains(int lane) const { return watched_[std::size_t(lane)]; }
  /// Does it come so near to a corridor, without a connection, that a driver on it sees nobody
  /// there whom he may touch?
  [[nodiscard]] bool is_beside(int lane) const { return is_beside_[std::size_t(lane)]; }
  /// From now on also the lanes of a corridor, those beside it, where others come so near that they
  /// may touch somebody on it, those from where they come, and those where their leaders are.
  void add(const Corridor& corridor);

 private:
  enum class Side { kBefore, kBehind };

  void add_driven(int lane);
  void add_along(int lane, Side side, double room);

  const LaneGraph& graph_;
  LanesBeside beside_;
  std::vector<bool> watched_;
  std::vector<bool> driven_;     ///< of each lane: part of a corridor
  std::vector<bool> is_beside_;  ///< of each lane: see is_beside()
};

}  // namespace mvtp
