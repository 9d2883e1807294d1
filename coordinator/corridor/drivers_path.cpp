#include "coordinator/corridor/drivers_path.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "coordinator/network/polyline.hpp"

namespace mvtp {

ReferencePath drivers_path(std::span<const Point> line, const Vehicle& body) {
  const double length = length_of(line);
  std::vector<Pose> poses;
  for (double s = body.length(); s <= length; s += ReferencePath::kSpacing) {
    const Point front = point_at(line, s);
    const double theta = heading(point_at(line, s - body.length()), front);
    poses.push_back(
        {front.x - body.front * std::cos(theta), front.y - body.front * std::sin(theta), theta});
  }
  if (poses.size() < 2) return ReferencePath(line);
  return ReferencePath(std::move(poses));
}

}  // namespace mvtp
