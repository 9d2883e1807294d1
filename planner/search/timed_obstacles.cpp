#include "planner/search/timed_obstacles.hpp"

#include <algorithm>
#include <utility>

namespace mvtp {

TimedObstacles::TimedObstacles(std::span<const SweptTrajectory* const> robots, int until,
                               std::span<const Reach> askers)
    : robots_(robots.begin(), robots.end()), until_(until) {
  for (const SweptTrajectory* robot : robots_) end_ = std::max(end_, robot->makespan());
  end_ = std::min(end_, until_);
  circles_.reserve(std::size_t(end_ + 1) * robots_.size());
  rows_.reserve(std::size_t(end_) + 2);
  for (int t = 0; t <= end_; ++t) {
    const auto row = std::ptrdiff_t(circles_.size());
    rows_.push_back(circles_.size());
    const int last = t < end_ ? t : until_;  // the last row serves all later steps
    const auto in_reach = [&](const Sweep& sweep) {
      return askers.empty() || std::ranges::any_of(askers, [&](const Reach& asker) {
               const double dx = sweep.centre().x - asker.from.x;
               const double dy = sweep.centre().y - asker.from.y;
               const double far =
                   sweep.radius() + asker.at_start + asker.per_step * (double(last) + 1.0);
               return dx * dx + dy * dy <= far * far;
             });
    };
    for (int i = 0; i < int(robots_.size()); ++i) {
      const Sweep& sweep = robots_[std::size_t(i)]->at(t);
      if (!in_reach(sweep)) continue;
      circles_.push_back({sweep.centre().x, sweep.centre().y, sweep.radius(), i});
      largest_ = std::max(largest_, sweep.radius());
    }
    std::sort(circles_.begin() + row, circles_.end(), [](const Circle& a, const Circle& b) {
      return std::pair(a.x, a.robot) < std::pair(b.x, b.robot);
    });
  }
  rows_.push_back(circles_.size());
}

template <class Visitor>
void TimedObstacles::for_each_near(const Sweep& sweep, int t, const Visitor& visitor) const {
  if (t >= until_ || circles_.empty()) return;
  const Point centre = sweep.centre();
  const double strip = sweep.radius() + largest_;
  const auto row = std::size_t(std::min(t, end_));
  const auto first = circles_.begin() + std::ptrdiff_t(rows_[row]);
  const auto last = circles_.begin() + std::ptrdiff_t(rows_[row + 1]);
  const auto near = std::ranges::lower_bound(first, last, centre.x - strip, {}, &Circle::x);
  for (auto circle = near; circle != last && circle->x <= centre.x + strip; ++circle) {
    const double dx = centre.x - circle->x;
    const double dy = centre.y - circle->y;
    const double reach = sweep.radius() + circle->radius;
    if (dx * dx + dy * dy > reach * reach) continue;
    if (!visitor(robots_[std::size_t(circle->robot)]->at(t))) return;
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
