#include "tools/toio/plan/reference.hpp"

#include <algorithm>
#include <cmath>

namespace mvtp {
namespace {

constexpr double kStands = 0.001;  // slower is no direction [m/s]

/// The speeds of the arc between two poses.
Twist twist_between(const Pose& a, const Pose& b, double duration) {
  const double turn = wrap_to_pi(b.theta - a.theta);
  const double middle = a.theta + turn / 2;
  const double driven = (b.x - a.x) * std::cos(middle) + (b.y - a.y) * std::sin(middle);
  return {driven / duration, turn / duration};
}

}  // namespace

Reference::Reference(const RunRobot& robot, const DeskFrame& desk)
    : segment_starts_(robot.segment_starts) {
  for (const RunWaypoint& waypoint : robot.waypoints) {
    times_.push_back(waypoint.time);
    poses_.push_back(desk.to_desk(waypoint.pose));
  }
  arcs_.push_back(0.0);
  double direction = 0.0;
  for (std::size_t k = 1; k < times_.size(); ++k) {
    const double duration = times_[k] - times_[k - 1];
    const Twist twist = twist_between(poses_[k - 1], poses_[k], duration);
    twists_.push_back(twist);
    arcs_.push_back(arcs_.back() + std::abs(twist.v) * duration);
    if (std::abs(twist.v) < kStands) continue;
    if (direction * twist.v < 0.0) cusps_.push_back(times_[k - 1]);
    direction = twist.v;
  }
  twists_.push_back({});
}

Reference::State Reference::at(double time) const {
  if (time < times_.front()) return {poses_.front(), {}, 0.0};
  if (time >= times_.back()) return {poses_.back(), {}, arcs_.back()};
  const auto after = std::ranges::upper_bound(times_, time);
  const auto k = std::size_t(after - times_.begin()) - 1;
  const double share = (time - times_[k]) / (times_[k + 1] - times_[k]);
  const Pose& a = poses_[k];
  const Pose& b = poses_[k + 1];
  return {{a.x + share * (b.x - a.x), a.y + share * (b.y - a.y),
           wrap_to_pi(a.theta + share * wrap_to_pi(b.theta - a.theta))},
          twists_[k],
          arcs_[k] + share * (arcs_[k + 1] - arcs_[k])};
}

double Reference::next_cusp(double time) const {
  const auto cusp = std::ranges::lower_bound(cusps_, time);
  return cusp == cusps_.end() ? end() : *cusp;
}

}  // namespace mvtp
