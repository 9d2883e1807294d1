#pragma once

#include <span>
#include <vector>

#include "planner/geometry/moving_box.hpp"
#include "planner/problem/parking_lot.hpp"

namespace mvtp {

/// Ground on which no car may come to rest under way: where people cross.
class KeepClear {
 public:
  explicit KeepClear(std::span<const Footpath> footpaths);

  /// Does a box reach onto it?
  [[nodiscard]] bool touches(const BoxPose& pose, const BoxShape& shape) const;

 private:
  struct Strip {
    BoxPose pose;
    BoxShape shape;
  };
  std::vector<Strip> strips_;
};

}  // namespace mvtp
