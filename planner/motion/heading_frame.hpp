#pragma once

#include <cmath>

#include "planner/motion/arc.hpp"
#include "planner/motion/moving_box.hpp"

namespace mvtp {

/// A pose whose heading is a unit vector: moves along arcs without trigonometry.
struct HeadingFrame {
  double x = 0.0;
  double y = 0.0;
  double ux = 1.0;
  double uy = 0.0;

  HeadingFrame() = default;
  explicit HeadingFrame(const Pose& pose)
      : x(pose.x), y(pose.y), ux(std::cos(pose.theta)), uy(std::sin(pose.theta)) {}
  HeadingFrame(double px, double py, double cosine, double sine)
      : x(px), y(py), ux(cosine), uy(sine) {}

  /// The frame `b`, given in this one, in the world.
  [[nodiscard]] HeadingFrame then(const HeadingFrame& b) const {
    return {x + ux * b.x - uy * b.y, y + uy * b.x + ux * b.y, ux * b.ux - uy * b.uy,
            uy * b.ux + ux * b.uy};
  }

  /// The body whose middle is `ahead` [m] of the rear axle.
  [[nodiscard]] BoxPose box(double ahead) const {
    return {float(x + ahead * ux), float(y + ahead * uy), float(ux), float(uy)};
  }
};

/// Where an arc leads from the origin.
[[nodiscard]] inline HeadingFrame arc_end(const Arc& arc) {
  return HeadingFrame(drive(Pose{}, arc));
}

}  // namespace mvtp
