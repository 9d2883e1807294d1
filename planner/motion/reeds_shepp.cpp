#include "planner/motion/reeds_shepp.hpp"

#include <ompl/base/spaces/ReedsSheppStateSpace.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mvtp {
namespace {

using Curve = ompl::base::ReedsSheppStateSpace::ReedsSheppPath;

// The table covers x, y in [0, kRange] and all headings; mirror images give the other quadrants.
constexpr double kRange = 8.0;  // [radii]
constexpr int kCells = 28;      // per axis
constexpr int kHeadings = 48;
constexpr double kCell = kRange / kCells;
constexpr double kHeading = 2.0 * std::numbers::pi / kHeadings;

}  // namespace

/// The unit-radius space with two scratch states.
struct ReedsShepp::Space {
  using State = ompl::base::SE2StateSpace::StateType;

  Space() : from(space.allocState()->as<State>()), to(space.allocState()->as<State>()) {}
  ~Space() {
    space.freeState(from);
    space.freeState(to);
  }
  Space(const Space&) = delete;
  Space& operator=(const Space&) = delete;

  Curve curve(const Pose& goal) const {
    from->setXY(0.0, 0.0);
    from->setYaw(0.0);
    to->setXY(goal.x, goal.y);
    to->setYaw(goal.theta);
    return space.reedsShepp(from, to);
  }

  ompl::base::ReedsSheppStateSpace space{1.0};
  State* from;
  State* to;
};

ReedsShepp::ReedsShepp() : space_(std::make_unique<Space>()) {}
ReedsShepp::~ReedsShepp() = default;
ReedsShepp::ReedsShepp(ReedsShepp&&) noexcept = default;
ReedsShepp& ReedsShepp::operator=(ReedsShepp&&) noexcept = default;

double ReedsShepp::length(const Pose& from, const Pose& to, double radius) const {
  const Pose goal = relative(from, to);
  return radius * space_->curve({goal.x / radius, goal.y / radius, goal.theta}).length();
}

std::vector<Arc> ReedsShepp::path(const Pose& from, const Pose& to, double radius) const {
  using Ompl = ompl::base::ReedsSheppStateSpace;
  const Pose goal = relative(from, to);
  const Curve curve = space_->curve({goal.x / radius, goal.y / radius, goal.theta});
  std::vector<Arc> arcs;
  for (int i = 0; i < 5; ++i) {
    const double length = curve.length_[i] * radius;
    switch (curve.type_[i]) {
      case Ompl::RS_LEFT:
        arcs.push_back({length, 1.0 / radius});
        break;
      case Ompl::RS_RIGHT:
        arcs.push_back({length, -1.0 / radius});
        break;
      case Ompl::RS_STRAIGHT:
        arcs.push_back({length, 0.0});
        break;
      case Ompl::RS_NOP:
        break;
    }
  }
  std::erase_if(arcs, [](const Arc& arc) { return std::abs(arc.length) < 1e-9; });
  return arcs;
}

ReedsSheppTable::ReedsSheppTable()
    : lengths_(std::size_t((kCells + 1) * (kCells + 1) * kHeadings), -1.0F) {}

double ReedsSheppTable::entry(int x, int y, int heading) const {
  float& length = lengths_[std::size_t((x * (kCells + 1) + y) * kHeadings + heading % kHeadings)];
  if (length < 0.0F) {
    length = float(curves_.length({}, {x * kCell, y * kCell, wrap_to_pi(heading * kHeading)}, 1.0));
  }
  return double(length);
}

double ReedsSheppTable::length(double x, double y, double theta) const {
  // A path mirrored at either axis is a path; each mirror turns the heading round.
  if (x < 0.0) theta = -theta;
  if (y < 0.0) theta = -theta;
  x = std::abs(x);
  y = std::abs(y);
  const double far = std::max(x, y);
  if (far <= kRange) return inside(x, y, theta);
  // Far away the path is a long straight line between two turns that depend on directions only.
  const double scale = kRange / far;
  return inside(x * scale, y * scale, theta) + (1.0 - scale) * std::hypot(x, y);
}

double ReedsSheppTable::inside(double x, double y, double theta) const {
  double heading = theta / kHeading;
  heading -= std::floor(heading / kHeadings) * kHeadings;
  const int ix = std::min(int(x / kCell), kCells - 1);
  const int iy = std::min(int(y / kCell), kCells - 1);
  const int ih = std::min(int(heading), kHeadings - 1);
  const double fx = x / kCell - ix;
  const double fy = y / kCell - iy;
  const double fh = heading - ih;
  const auto along_heading = [&](int cx, int cy) {
    const double a = entry(cx, cy, ih);
    const double b = entry(cx, cy, ih + 1);
    return a + fh * (b - a);
  };
  const double low = along_heading(ix, iy) * (1 - fx) + along_heading(ix + 1, iy) * fx;
  const double high = along_heading(ix, iy + 1) * (1 - fx) + along_heading(ix + 1, iy + 1) * fx;
  return low * (1 - fy) + high * fy;
}

}  // namespace mvtp
