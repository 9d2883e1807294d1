#include "planner/motion/stepped_car.hpp"

#include <cmath>

namespace mvtp {
namespace {

constexpr double kOnBorder = 1e-6;  // [m]; rounding must not push a robot off the map

bool inside(const Map& map, const Extent& extent) {
  return extent.min_x >= -kOnBorder && extent.min_y >= -kOnBorder &&
         extent.max_x <= map.width + kOnBorder && extent.max_y <= map.height + kOnBorder;
}

}  // namespace

SteppedCar::SteppedCar(const Vehicle& vehicle, double dt, CollisionRule rule, const Map& map,
                       const Obstacles& obstacles, const Exemptions* exemptions)
    : vehicle_(vehicle),
      dt_(dt),
      rule_(rule),
      map_(&map),
      obstacles_(&obstacles),
      exemptions_(exemptions) {
  const double length = step_length();
  const double k = vehicle.max_curvature();
  arcs_ = {{{length, 0.0}, {length, k}, {length, -k}, {-length, 0.0}, {-length, k}, {-length, -k}}};
  primitives_ = primitives(1.0);
}

std::vector<Primitive> SteppedCar::primitives(double scale) const {
  std::vector<Primitive> result;
  for (Arc arc : arcs_) {
    arc.length *= scale;
    result.push_back({arc, drive({}, arc), sweep({}, arc)});
  }
  result.push_back({{}, {}, sweep({}, {})});
  return result;
}

bool SteppedCar::in_bounds(const Pose& from, const Arc& arc) const {
  // No point of the body is farther from its rear axle than this, nor the axle than its path.
  const double margin =
      std::abs(arc.length) +
      (map_->bounds == Bounds::kAxle
           ? 0.0
           : std::hypot(std::max(vehicle_.front, vehicle_.rear), vehicle_.width / 2));
  if (inside(*map_, {from.x - margin, from.y - margin, from.x + margin, from.y + margin})) {
    return true;
  }
  const Pose start = rule_ == CollisionRule::kContinuous ? from : drive(from, arc);
  const Arc driven = rule_ == CollisionRule::kContinuous ? arc : Arc{};
  return inside(*map_, map_->bounds == Bounds::kAxle ? axle_extent(start, driven)
                                                     : body_extent(vehicle_, start, driven));
}

bool SteppedCar::is_exempt(const Pose& from, const Arc& arc, const Sweep& sweep) const {
  if (exemptions_ == nullptr) return false;
  return rule_ == CollisionRule::kContinuous
             ? exemptions_->allow(*obstacles_, sweep, from, arc)
             : exemptions_->allow(*obstacles_, sweep, drive(from, arc), {});
}

std::vector<Arc> SteppedCar::steps(const std::vector<Arc>& path) const {
  std::vector<Arc> result;
  for (const Arc& arc : path) {
    double left = std::abs(arc.length);
    const double sign = arc.length < 0.0 ? -1.0 : 1.0;
    // A last bit shorter than rounding joins the step before it: no step of its own for nothing.
    const double slack = 1e-9 * step_length();
    while (left > slack) {
      const double length = left <= step_length() + slack ? left : step_length();
      result.push_back({sign * std::min(length, step_length()), arc.curvature});
      left -= length;
    }
  }
  return result;
}

}  // namespace mvtp
