#pragma once

#include <cmath>
#include <memory>
#include <optional>

#include "planner/motion/grid_distance.hpp"
#include "planner/motion/reeds_shepp.hpp"

namespace mvtp {

/// How far a robot has to drive to its goal at least, nearly: the heuristic H [m].
///
/// The larger of the Reeds-Shepp length (from a table) and the path around obstacles inflated by
/// nearly half the width of the vehicle (on a grid). Not a bound: off by a few decimetres.
class CostToGo {
 public:
  /// @param table     outlives this object.
  /// @param obstacles nullptr if there are none.
  CostToGo(const Pose& goal, double radius, const ReedsSheppTable& table,
           std::shared_ptr<const ObstacleGrid> obstacles)
      : goal_(goal),
        cos_(std::cos(goal.theta)),
        sin_(std::sin(goal.theta)),
        radius_(radius),
        table_(&table) {
    if (obstacles) grid_.emplace(std::move(obstacles), Point{goal.x, goal.y});
  }

  [[nodiscard]] double operator()(const Pose& pose) const {
    const double dx = (pose.x - goal_.x) / radius_;
    const double dy = (pose.y - goal_.y) / radius_;
    const double curve = radius_ * table_->length(cos_ * dx + sin_ * dy, cos_ * dy - sin_ * dx,
                                                  pose.theta - goal_.theta);
    if (!grid_) return curve;
    const double path = grid_->at(pose.x, pose.y);
    return std::isfinite(path) ? std::max(curve, path) : curve;
  }

  [[nodiscard]] const Pose& goal() const { return goal_; }

 private:
  Pose goal_;
  double cos_;
  double sin_;
  double radius_;
  const ReedsSheppTable* table_;
  std::optional<GridDistance> grid_;
};

}  // namespace mvtp
