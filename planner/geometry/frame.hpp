#pragma once

#include <cmath>

#include "planner/geometry/arc.hpp"

namespace mvtp {

/// A pose with the unit vector of its heading at hand: moves along arcs without trigonometry.
struct Frame {
  double x = 0.0;
  double y = 0.0;
  double ux = 1.0;
  double uy = 0.0;

  Frame() = default;
  explicit Frame(const Pose& pose)
      : x(pose.x), y(pose.y), ux(std::cos(pose.theta)), uy(std::sin(pose.theta)) {}
  Frame(double px, double py, double cosine, double sine) : x(px), y(py), ux(cosine), uy(sine) {}

  /// The point (ahead, left) of this frame in the world.
  [[nodiscard]] Point world(double ahead, double left) const {
    return {x + ux * ahead - uy * left, y + uy * ahead + ux * left};
  }

  /// The frame `b`, given in this one, in the world.
  [[nodiscard]] Frame then(const Frame& b) const {
    const Point origin = world(b.x, b.y);
    return {origin.x, origin.y, ux * b.ux - uy * b.uy, uy * b.ux + ux * b.uy};
  }
};

/// Where an arc leads from the origin.
[[nodiscard]] inline Frame arc_end(const Arc& arc) { return Frame(drive(Pose{}, arc)); }

}  // namespace mvtp
