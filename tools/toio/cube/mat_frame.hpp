#pragma once

#include <numbers>

#include "planner/problem/pose.hpp"
#include "tools/toio/cube/cube.hpp"
#include "tools/toio/cube/mat.hpp"

/// Three frames meet here:
/// - the plan's: metres of the plan, y up, counter-clockwise, rear axle of the planned car;
/// - the desk's: true metres on the mat from its lower left corner, y up, counter-clockwise; a pose
///   is that of the cube's wheel axle, heading where the planned car heads. A car's rear axle and a
///   cube's wheel axle move alike, along their heading, so the one stands for the other;
/// - the mat's: dots, y down, degrees clockwise; a pose is the one that the cube reports.
namespace mvtp {

inline constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

/// From the plan to the desk: scaled, turned by quarters, shifted.
struct PlanFrame {
  double scale = 0.02;    ///< metres on the desk per metre of the plan
  int quarter_turns = 0;  ///< counter-clockwise, 0 ... 3
  Point origin;           ///< where the origin of the plan is on the desk

  [[nodiscard]] Pose to_desk(const Pose& plan) const;
  [[nodiscard]] Pose to_plan(const Pose& desk) const;

  friend bool operator==(const PlanFrame&, const PlanFrame&) = default;
};

/// Where a cube says that it is, or should say so; fractions where nothing was rounded.
struct MatPose {
  double x = 0.0;
  double y = 0.0;
  double degrees = 0.0;  ///< [0, 360)

  friend bool operator==(const MatPose&, const MatPose&) = default;
};

/// How a cube on a mat reports its poses.
struct DeskFrame {
  Mat mat;
  Cube cube;
  Facing facing = Facing::kNoseFirst;

  /// What the cube's centre reports when its axle is at `desk`.
  [[nodiscard]] MatPose to_mat(const Pose& desk) const;
  [[nodiscard]] Pose to_desk(const MatPose& mat_pose) const;
  /// Where on the mat the sensor is when the axle is at `desk`; the angle is the cube's.
  [[nodiscard]] MatPose sensor(const Pose& desk) const;

  /// The same place with the heading of the cube's own nose; the inverse of itself.
  [[nodiscard]] Pose own_heading(const Pose& desk) const;

 private:
  [[nodiscard]] MatPose dots(const Pose& point) const;
};

/// Whole dots and degrees, as cubes report them.
[[nodiscard]] MatPose rounded(const MatPose& pose);

}  // namespace mvtp
