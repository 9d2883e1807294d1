#include "planner/search/traffic.hpp"

#include <algorithm>

namespace mvtp {

Traffic::Traffic(std::span<const MovingObstacle* const> robots)
    : robots_(robots.begin(), robots.end()) {
  for (const MovingObstacle* robot : robots_) end_ = std::max(end_, robot->makespan());
  circles_.reserve(std::size_t(end_ + 1) * robots_.size());
  for (int t = 0; t <= end_; ++t) {
    for (const MovingObstacle* robot : robots_) {
      const Sweep& sweep = robot->at(t);
      circles_.push_back({sweep.centre().x, sweep.centre().y, sweep.radius()});
    }
  }
}

template <class Visit>
void Traffic::for_each_near(const Sweep& sweep, int t, const Visit& visit) const {
  const Point centre = sweep.centre();
  const Circle* circle = circles_.data() + std::size_t(std::min(t, end_)) * robots_.size();
  for (std::size_t i = 0; i < robots_.size(); ++i, ++circle) {
    const double dx = centre.x - circle->x;
    const double dy = centre.y - circle->y;
    const double reach = sweep.radius() + circle->radius;
    if (dx * dx + dy * dy <= reach * reach && !visit(robots_[i]->at(t))) return;
  }
}

bool Traffic::hit(const Sweep& sweep, int t) const {
  bool found = false;
  for_each_near(sweep, t, [&](const Sweep& other) {
    found = collide(sweep, other);
    return !found;
  });
  return found;
}

int Traffic::count(const Sweep& sweep, int t) const {
  int found = 0;
  for_each_near(sweep, t, [&](const Sweep& other) {
    found += collide(sweep, other) ? 1 : 0;
    return true;
  });
  return found;
}

}  // namespace mvtp
