#include "tools/toio/cube/mat_frame.hpp"

#include <cmath>
#include <numbers>

namespace mvtp {
namespace {

double wrap_to_360(double degrees) {
  const double wrapped = std::fmod(degrees, 360.0);
  return wrapped < 0.0 ? wrapped + 360.0 : wrapped;
}

/// The point turned counter-clockwise by quarters, without rounding.
Point turned(const Point& p, int quarters) {
  switch (quarters & 3) {
    case 1:
      return {-p.y, p.x};
    case 2:
      return {-p.x, -p.y};
    case 3:
      return {p.y, -p.x};
    default:
      return p;
  }
}

}  // namespace

Pose PlanFrame::to_desk(const Pose& plan) const {
  const Point p = turned({plan.x * scale, plan.y * scale}, quarter_turns);
  return {origin.x + p.x, origin.y + p.y,
          wrap_to_pi(plan.theta + quarter_turns * std::numbers::pi / 2.0)};
}

Pose PlanFrame::to_plan(const Pose& desk) const {
  const Point p = turned({desk.x - origin.x, desk.y - origin.y}, 4 - quarter_turns);
  return {p.x / scale, p.y / scale,
          wrap_to_pi(desk.theta - quarter_turns * std::numbers::pi / 2.0)};
}

Pose DeskFrame::own_heading(const Pose& desk) const {
  const double offset = facing == Facing::kTailFirst ? std::numbers::pi : 0.0;
  return {desk.x, desk.y, wrap_to_pi(desk.theta + offset)};
}

MatPose DeskFrame::dots(const Pose& point) const {
  return {mat.min_x + point.x / mat.metres_per_dot, mat.max_y - point.y / mat.metres_per_dot,
          wrap_to_360(-point.theta * kDegreesPerRadian)};
}

MatPose DeskFrame::to_mat(const Pose& desk) const {
  return dots(compose(own_heading(desk), {-cube.center_to_axle, 0.0, 0.0}));
}

Pose DeskFrame::to_desk(const MatPose& mat_pose) const {
  const Pose centre{(mat_pose.x - mat.min_x) * mat.metres_per_dot,
                    (mat.max_y - mat_pose.y) * mat.metres_per_dot,
                    wrap_to_pi(-mat_pose.degrees / kDegreesPerRadian)};
  return own_heading(compose(centre, {cube.center_to_axle, 0.0, 0.0}));
}

MatPose DeskFrame::sensor(const Pose& desk) const {
  return dots(compose(own_heading(desk), {-cube.sensor_behind, cube.sensor_left, 0.0}));
}

MatPose rounded(const MatPose& pose) {
  return {std::round(pose.x), std::round(pose.y), wrap_to_360(std::round(pose.degrees))};
}

}  // namespace mvtp
