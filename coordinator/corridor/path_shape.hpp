#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "planner/geometry.hpp"

namespace mvtp {

/// How a path swings to the outside (positive) or inside of one turn, before and behind it.
struct Swing {
  double in = 0.0;        ///< [m] at the widest place before the turn
  double out = 0.0;       ///< [m] behind it
  double lead_in = 8.0;   ///< [m] from the widest place to the turn
  double lead_out = 8.0;  ///< [m] from the turn to the widest place behind it
};

/// How a path departs from the lanes' centre line.
struct PathShape {
  double sigma = 2.5;         ///< [m] of the smoothing
  double follow = 0.0;        ///< [m] ahead of the rear axle lies the point that keeps to the curve
  std::vector<Swing> swings;  ///< one per turn
};

/// The place of a sharpest bend [m], and its direction: 1 to the left, -1 to the right.
struct SharpTurn {
  double s = 0.0;
  double side = 1.0;
};

/// The sharpest places of all bends that may need a wider path.
[[nodiscard]] std::vector<SharpTurn> turns_of(const ReferencePath& path);

/// The lanes' centre line, sampled evenly: where a shape departs from it to the right.
struct ShapeBase {
  struct Place {
    Point at;
    Point right;
  };
  double spacing;  ///< [m]
  std::vector<Place> places;

  ShapeBase(const ReferencePath& path, double apart) : spacing(apart) {
    const auto n = std::size_t(path.length() / apart) + 1;
    places.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Pose p = path.at(double(i) * apart);
      places.push_back({{p.x, p.y}, {std::sin(p.theta), -std::cos(p.theta)}});
    }
  }
};

/// The base pushed to the outside of its turns before and behind them, smoothed, and followed.
[[nodiscard]] std::vector<Point> shaped(const ShapeBase& base, std::span<const SharpTurn> turns,
                                        const PathShape& shape);

}  // namespace mvtp
