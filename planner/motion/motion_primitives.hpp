#pragma once

#include <array>
#include <vector>

#include "planner/motion/arc_trajectory.hpp"
#include "planner/motion/exemptions.hpp"
#include "planner/motion/obstacles.hpp"
#include "planner/problem/deadline.hpp"
#include "planner/problem/instance.hpp"

namespace mvtp {

/// A lower bound on the distance from any point to the nearest obstacle, from a grid.
class Clearance {
 public:
  /// @param deadline  once it has expired: the same as unknown()
  Clearance(const Map& map, const Obstacles& obstacles,
            const Deadline& deadline = Deadline::never());
  /// Knows nothing: 0 everywhere. For maps that change too often to be worth the work.
  [[nodiscard]] static Clearance unknown() { return Clearance(); }

  /// [m], no more than kFar; 0 near obstacles and outside the map.
  [[nodiscard]] float at(double x, double y) const;

  static constexpr double kFar = 8.0;

 private:
  static constexpr double kSide = 0.5;

  Clearance() : distance_(1, 0.0F) {}

  int columns_ = 0;
  int rows_ = 0;
  double side_ = kSide;
  std::vector<float> distance_;  ///< empty without obstacles
};

/// A car that drives the motion primitives of the search, one per macro step of time: straight,
/// left, right, each forwards and in reverse, at full speed, and waiting; then the first six again
/// at a third of the speed, for tight places.
///
/// The obstacles of the map are those of all cars; they and the map outlive this object.
class MotionPrimitives {
 public:
  /// @param exemptions from the obstacles, outlives this object; nullptr: none
  MotionPrimitives(const Vehicle& vehicle, TimeGrid time, const Map& map,
                   const Obstacles& obstacles, const Clearance& clearance,
                   const Exemptions* exemptions = nullptr);

  struct Primitive {
    Arc arc;
    int turn = 0;      ///< change of heading in units of turn()
    Frame end;         ///< of the rear axle, in the frame it starts from
    float travel = 0;  ///< of any point of the body, per time step [m]
    float radius = 0;  ///< of a circle around the body's middle half way that contains all of it
    std::vector<BoxPose> boxes;  ///< in the frame of the rear axle at the start, macro step + 1
    SweptBox swept;              ///< around all of it, in the same frame
  };
  static constexpr int kWait = 6;
  static constexpr int kQuick = 7;  ///< so many without the slow ones

  [[nodiscard]] const std::array<Primitive, 13>& primitives() const { return primitives_; }
  /// The one at full speed that an arc of this curvature begins with; nullptr if there is none.
  [[nodiscard]] const Primitive* beginning_of(const Arc& arc) const;
  /// The change of heading of a slow turning motion primitive [rad].
  [[nodiscard]] double turn() const { return turn_; }
  [[nodiscard]] const Vehicle& vehicle() const { return vehicle_; }
  [[nodiscard]] const Exemptions* exemptions() const { return exemptions_; }
  [[nodiscard]] const BoxShape& shape() const { return shape_; }
  [[nodiscard]] const TimeGrid& time() const { return time_; }
  /// The middle of the body, from the rear axle [m].
  [[nodiscard]] double ahead() const { return (vehicle_.front - vehicle_.rear) / 2; }
  /// The path driven between two time steps at full speed [m].
  [[nodiscard]] double step_length() const { return vehicle_.max_speed * time_.dt; }
  /// Radius of a circle around the middle of the body half way through one motion primitive that
  /// contains it all the time [m].
  [[nodiscard]] float reach() const { return reach_; }

  /// Radius of a circle around the middle of the body at the start of any motion primitive that
  /// contains it until the end [m].
  [[nodiscard]] float reach_of_all() const { return reach_of_all_; }

  /// May the car drive the arc, as far as the map and its obstacles go?
  [[nodiscard]] bool is_free(const Pose& from, const Arc& arc) const;
  /// The same for arcs of at most one motion primitive, with the body's middle half way; quicker.
  [[nodiscard]] bool is_free(const Pose& from, const Arc& arc, const BoxPose& halfway) const;

 private:
  [[nodiscard]] bool in_bounds(const Pose& from, const Arc& arc) const;
  [[nodiscard]] bool is_clear(const Pose& from, const Arc& arc) const;

  Vehicle vehicle_;
  TimeGrid time_;
  const Map* map_;
  const Obstacles* obstacles_;
  const Clearance* clearance_;
  const Exemptions* exemptions_;
  BoxShape shape_;
  float reach_;
  float reach_of_all_ = 0.0F;
  double turn_;
  std::array<Primitive, 13> primitives_;
};

}  // namespace mvtp
