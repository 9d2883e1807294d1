#pragma once

#include <array>
#include <vector>

#include "planner/problem/deadline.hpp"
#include "planner/problem/instance.hpp"

namespace mvtp {

/// The gaps between obstacles that a disc cannot pass, and what they shut off.
///
/// Obstacles closer to each other than the disc is wide are linked by a line that its centre cannot
/// cross. Two places are separated if links and obstacles form a closed curve around one of them:
/// one that the straight line between them crosses an odd number of times. That is exact, and does
/// not depend on any grid.
class Passages {
 public:
  /// @param radius   of the disc [m]
  /// @param outside  how far its centre may be outside the map; negative: must be inside [m]
  /// @param deadline  gaps that are left when it expires are taken to be wide enough
  Passages(const Map& map, double radius, double outside,
           const Deadline& deadline = Deadline::never());

  /// Is there no path at all for the disc's centre? @pre it may be at both places.
  [[nodiscard]] bool separated(const Point& from, const Point& to) const;

 private:
  /// A circle around a == b, or the edge of a polygon from a to b.
  struct Wall {
    Point a;
    Point b;
    double radius;
  };
  /// A line from walls_[i].a over the narrowest gap to walls_[j].a, all of it out of reach.
  struct Link {
    int i;
    int j;
    std::array<Point, 4> line;
  };
  void add_polygon(const Polygon& polygon);
  void link(int i, int j, double width);

  std::vector<Wall> walls_;
  std::vector<Link> links_;
};

}  // namespace mvtp
