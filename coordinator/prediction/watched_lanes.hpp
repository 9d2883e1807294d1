#pragma once

#include <vector>

#include "coordinator/corridor/corridor.hpp"
#include "coordinator/network/lanes_beside.hpp"

namespace mvtp {

/// The lanes on which drivers matter to those under control.
class WatchedLanes {
 public:
  /// At first those of coordinated junctions. @param graph  outlives this.
  WatchedLanes(const LaneGraph& graph, const CourseFinder& finder);

  [[nodiscard]] bool contains(int lane) const { return watched_[std::size_t(lane)]; }
  /// From now on also the lanes of a corridor, those beside it, where others come so near that they
  /// may touch somebody on it, and those from where they come.
  void add(const Corridor& corridor);

 private:
  void add_driven(int lane);
  void add_up_to(int lane, double before);

  const LaneGraph& graph_;
  LanesBeside beside_;
  std::vector<bool> watched_;
  std::vector<bool> driven_;  ///< of each lane: part of a corridor
};

}  // namespace mvtp
