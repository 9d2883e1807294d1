#include "coordinator/corridor/drivers_path.hpp"

#include <cmath>
#include <vector>

#include "coordinator/network/polyline.hpp"

namespace mvtp {

ReferencePath drivers_path(std::span<const Point> line, const Vehicle& body) {
  constexpr double kStep = 0.5;  // [m]
  const double length = length_of(line);
  std::vector<Pose> poses;
  const auto add = [&](const Point& rear, const Point& front) {
    const double theta = heading(rear, front);
    const Point axle{front.x - body.front * std::cos(theta),
                     front.y - body.front * std::sin(theta)};
    if (!poses.empty() && std::hypot(axle.x - poses.back().x, axle.y - poses.back().y) < 0.05)
      return;
    poses.push_back({axle.x, axle.y, theta});
  };
  for (double s = body.length(); s <= length; s += kStep) {
    add(point_at(line, s - body.length()), point_at(line, s));
  }
  if (poses.size() < 2) return ReferencePath(line);
  return ReferencePath(std::span<const Pose>(poses));
}

}  // namespace mvtp
