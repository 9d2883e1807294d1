#include "planner/lot/keep_clear.hpp"

#include <algorithm>
#include <cmath>

namespace mvtp {

KeepClear::KeepClear(std::span<const Footpath> footpaths) {
  for (const Footpath& path : footpaths) {
    for (std::size_t k = 1; k < path.line.size(); ++k) {
      const Point& a = path.line[k - 1];
      const Point& b = path.line[k];
      const double length = std::hypot(b.x - a.x, b.y - a.y);
      if (length == 0.0) continue;
      strips_.push_back({{float((a.x + b.x) / 2), float((a.y + b.y) / 2),
                          float((b.x - a.x) / length), float((b.y - a.y) / length)},
                         {float(length / 2), float(path.width / 2), 0.0F}});
    }
  }
}

bool KeepClear::touches(const BoxPose& pose, const BoxShape& shape) const {
  return std::ranges::any_of(strips_, [&](const Strip& strip) {
    return gap(pose, shape, strip.pose, strip.shape) < 0.0F;
  });
}

}  // namespace mvtp
