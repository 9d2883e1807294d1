#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "planner/geometry/arc.hpp"
#include "planner/geometry/sweep.hpp"
#include "planner/motion/exemptions.hpp"
#include "planner/motion/obstacles.hpp"
#include "planner/problem/instance.hpp"
#include "planner/problem/plan.hpp"

namespace mvtp {

/// A step that a car may try from anywhere, worked out once: as it is from the origin.
struct Primitive {
  Arc arc;
  Pose end;
  Sweep sweep;  ///< SteppedCar::sweep() of it

  /// The pose in which it ends when driven from `from`, whose frame is `frame`.
  [[nodiscard]] Pose end_from(const Pose& from, const Frame& frame) const {
    const Point point = frame.world(end.x, end.y);
    return {point.x, point.y, wrap_to_pi(from.theta + end.theta)};
  }
};

/// A step of `dt` [s] as the plan file gives it: the state it ends in, and what was held during it.
[[nodiscard]] inline Waypoint waypoint(const Vehicle& vehicle, const Arc& arc, const Pose& end,
                                       double dt) {
  return {end, arc.length / dt, std::atan(arc.curvature * vehicle.wheelbase)};
}

/// The paper's motion model: a car that may change speed and steering at once at every step, and so
/// stands at the end of each. Its safe stop is the pose itself.
///
/// Source: ESCoT paper, Sec. III-A: six arcs of v_max * dt (straight, left, right; forwards, in
/// reverse) and a wait. Arcs are driven exactly, not by the Euler steps of eq. (5).
class SteppedCar {
 public:
  /// @param obstacles  of `map`; both outlive this object, and so do
  /// @param exemptions from them; nullptr: none
  SteppedCar(const Vehicle& vehicle, double dt, CollisionRule rule, const Map& map,
             const Obstacles& obstacles, const Exemptions* exemptions = nullptr);

  [[nodiscard]] const Vehicle& vehicle() const { return vehicle_; }
  /// The path driven in one step at full speed [m].
  [[nodiscard]] double step_length() const { return vehicle_.max_speed * dt_; }
  /// The six arcs of a full step: straight, left, right, each forwards and in reverse.
  [[nodiscard]] const std::array<Arc, 6>& arcs() const { return arcs_; }

  /// The steps tried from everywhere: those arcs, and last a wait.
  [[nodiscard]] const std::vector<Primitive>& primitives() const { return primitives_; }
  /// The same with arcs `scale` times as long.
  [[nodiscard]] std::vector<Primitive> primitives(double scale) const;

  /// What may not overlap during a step: all of it, or under CollisionRule::kSteps its end.
  [[nodiscard]] Sweep sweep(const Pose& from, const Arc& arc) const {
    return rule_ == CollisionRule::kContinuous ? Sweep(vehicle_, from, arc)
                                               : Sweep(vehicle_, drive(from, arc), {});
  }

  /// Is the step inside the map and clear of its obstacles? `sweep` is sweep(from, arc).
  [[nodiscard]] bool is_free(const Pose& from, const Arc& arc, const Sweep& sweep) const {
    return in_bounds(from, arc) && (!obstacles_->hit(sweep) || is_exempt(from, arc, sweep));
  }
  [[nodiscard]] bool is_free(const Pose& from, const Arc& arc) const {
    return is_free(from, arc, sweep(from, arc));
  }
  [[nodiscard]] bool in_bounds(const Pose& from, const Arc& arc) const;

  /// Cuts a path into steps: every arc into full steps and a shorter last one.
  [[nodiscard]] std::vector<Arc> steps(const std::vector<Arc>& path) const;

  /// The step as the plan file gives it.
  [[nodiscard]] Waypoint waypoint(const Arc& arc, const Pose& end) const {
    return mvtp::waypoint(vehicle_, arc, end, dt_);
  }

 private:
  [[nodiscard]] bool is_exempt(const Pose& from, const Arc& arc, const Sweep& sweep) const;

  Vehicle vehicle_;
  double dt_;
  CollisionRule rule_;
  const Map* map_;
  const Obstacles* obstacles_;
  const Exemptions* exemptions_;
  std::array<Arc, 6> arcs_;
  std::vector<Primitive> primitives_;
};

}  // namespace mvtp
