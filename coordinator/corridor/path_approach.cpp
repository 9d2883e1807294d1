#include "coordinator/corridor/path_approach.hpp"

#include <algorithm>
#include <cmath>

#include "coordinator/audit/audit.hpp"

namespace mvtp {
namespace {

constexpr double kLength = 20.0;   ///< [m] of an approach
constexpr double kNotable = 0.02;  ///< [m], and per metre
constexpr double kAslant = 0.08;   ///< [m] per metre: it swings 0.3 m aside
constexpr double kSteepest = 0.6;  ///< [rad] between heading and path that is made up for
constexpr double kAcross = 1.5;    ///< [rad] beyond which the slope says no more
constexpr double kFarthest = 1.5;  ///< [m] beside the path from which it is reached

}  // namespace

PathApproach::PathApproach(const ReferencePath& path, const Pose& pose, double near)
    : begin_(near), length_(kLength) {
  for (int round = 0; round < 4; ++round) begin_ += relative(path.at(begin_), pose).x;
  const Pose offset = relative(path.at(begin_), pose);
  aside_ = offset.y;
  // On a bend, the metres beside the path are not those of the path.
  const double stretch = 1.0 - path.curvature(begin_) * aside_;
  slope_ = std::tan(std::clamp(wrap_to_pi(offset.theta), -kAcross, kAcross)) * stretch;
}

bool PathApproach::is_notable() const {
  return std::abs(aside_) > kNotable || std::abs(slope_) > kNotable;
}

double PathApproach::acceleration_share(const ReferencePath& path, double speed, double accel,
                                        std::span<const double> limits) const {
  constexpr double kStep = 0.5;  // [m]
  const auto limit = [&](double s) {
    const auto i = std::size_t(std::max(s, 0.0) / ReferencePath::kSpacing);
    return limits[std::min(i, limits.size() - 1)];
  };
  // Metres on the ground per metre of path.
  const auto ratio = [&](double s) {
    return distance(pose(path, s), pose(path, s + kStep)) / kStep;
  };
  double share = 1.0;
  double before = ratio(begin_);
  for (double s = begin_ + kStep; s < begin_ + length_ + kStep; s += kStep) {
    const double now = ratio(s);
    const double fastest =
        std::min(std::sqrt(speed * speed + 2.0 * accel * (s - begin_)), std::max(limit(s), speed));
    // The ground speed is r v: its change r a + r' v^2 is at most `accel`.
    const double changes = std::abs(now - before) / kStep * fastest * fastest;
    share = std::min(share, (accel - changes) / (std::max(before, now) * accel));
    before = now;
  }
  return share;
}

bool PathApproach::is_drivable(const ReferencePath& path, const Vehicle& body,
                               const DrivableArea& area) const {
  if (!is_notable()) return true;
  constexpr double kStep = 0.5;  // [m]
  Pose before = pose(path, begin_);
  const double askew = std::abs(wrap_to_pi(before.theta - path.at(begin_).theta));
  if (std::abs(aside_) > kFarthest || askew > kSteepest) return false;
  for (double s = begin_ + kStep; s <= begin_ + length_; s += kStep) {
    const Pose here = pose(path, s);
    const double turned = std::abs(wrap_to_pi(here.theta - before.theta));
    if (turned > body.max_curvature() * std::hypot(here.x - before.x, here.y - before.y))
      return false;
    if (area.share_outside(here, body, Audit::kRoadTolerance) > 0.0) return false;
    before = here;
  }
  return true;
}
bool PathApproach::is_aslant() const { return std::abs(slope_) > kAslant; }

Pose PathApproach::pose(const ReferencePath& path, double s) const {
  const double x = (s - begin_) / length_;
  if (x >= 1.0 || x < 0.0) return path.at(s);
  // The quintic with value and slope given at 0, no curvature there, and all three 0 at 1.
  const double y0 = aside_;
  const double m0 = slope_ * length_;
  const double c3 = -10.0 * y0 - 6.0 * m0;
  const double c4 = 15.0 * y0 + 8.0 * m0;
  const double c5 = -6.0 * y0 - 3.0 * m0;
  const double y = y0 + x * (m0 + x * x * (c3 + x * (c4 + x * c5)));
  const double slope = (m0 + x * x * (3.0 * c3 + x * (4.0 * c4 + x * 5.0 * c5))) / length_;
  const double stretch = 1.0 - path.curvature(s) * y;
  return compose(path.at(s), {0.0, y, std::atan2(slope, stretch)});
}

}  // namespace mvtp
