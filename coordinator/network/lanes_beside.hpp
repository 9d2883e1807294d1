#pragma once

#include <vector>

#include "coordinator/network/lane_graph.hpp"

namespace mvtp {

/// Lanes that come so near to each other that vehicles on them may touch, though no connection says
/// so: in bends of a road, where the tails of those who come the other way swing over its middle.
class LanesBeside {
 public:
  static constexpr double kNear = 2.5;  ///< [m] between the middles of two lanes,
  /// and so much more where a road bends: tails swing
  static constexpr double kSwing = 2.0;

  /// @param graph  outlives this.
  explicit LanesBeside(const LaneGraph& graph);

  /// The lanes that come so near to this one, ascending; but those that come from the same lane as
  /// it does, or lead onto the same.
  [[nodiscard]] std::vector<int> of(int lane) const;

 private:
  struct Bounds {
    Point low, high;
  };
  [[nodiscard]] std::vector<int> joined_with(int lane) const;
  [[nodiscard]] bool come_near(int lane, int other) const;
  [[nodiscard]] bool comes_near(int lane, int other) const;
  [[nodiscard]] bool is_looked_over(int lane) const;

  const LaneGraph& graph_;
  std::vector<Bounds> bounds_;
};

}  // namespace mvtp
