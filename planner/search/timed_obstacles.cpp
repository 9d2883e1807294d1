#include "planner/search/timed_obstacles.hpp"

#include <algorithm>
#include <utility>

namespace mvtp {

TimedObstacles::TimedObstacles(std::span<const MovingObstacle* const> robots, int until)
    : robots_(robots.begin(), robots.end()), until_(until) {
  for (const MovingObstacle* robot : robots_) end_ = std::max(end_, robot->makespan());
  end_ = std::min(end_, until_);
  circles_.reserve(std::size_t(end_ + 1) * robots_.size());
  for (int t = 0; t <= end_; ++t) {
    const auto row = circles_.end() - circles_.begin();
    for (int i = 0; i < int(robots_.size()); ++i) {
      const Sweep& sweep = robots_[std::size_t(i)]->at(t);
      circles_.push_back({sweep.centre().x, sweep.centre().y, sweep.radius(), i});
      largest_ = std::max(largest_, sweep.radius());
    }
    std::sort(circles_.begin() + row, circles_.end(), [](const Circle& a, const Circle& b) {
      return std::pair(a.x, a.robot) < std::pair(b.x, b.robot);
    });
  }
}

template <class Visit>
void TimedObstacles::for_each_near(const Sweep& sweep, int t, const Visit& visit) const {
  if (t >= until_) return;
  const Point centre = sweep.centre();
  const double strip = sweep.radius() + largest_;
  const auto n = std::ptrdiff_t(robots_.size());
  const auto first = circles_.begin() + std::min(t, end_) * n;
  const auto near = std::ranges::lower_bound(first, first + n, centre.x - strip, {}, &Circle::x);
  for (auto circle = near; circle != first + n && circle->x <= centre.x + strip; ++circle) {
    const double dx = centre.x - circle->x;
    const double dy = centre.y - circle->y;
    const double reach = sweep.radius() + circle->radius;
    if (dx * dx + dy * dy > reach * reach) continue;
    if (!visit(robots_[std::size_t(circle->robot)]->at(t))) return;
  }
}

bool TimedObstacles::hit(const Sweep& sweep, int t) const {
  bool found = false;
  for_each_near(sweep, t, [&](const Sweep& other) {
    found = collide(sweep, other);
    return !found;
  });
  return found;
}

int TimedObstacles::count(const Sweep& sweep, int t) const {
  int found = 0;
  for_each_near(sweep, t, [&](const Sweep& other) {
    found += collide(sweep, other) ? 1 : 0;
    return true;
  });
  return found;
}

}  // namespace mvtp
