#include "planner/motion/exemptions.hpp"

#include <algorithm>

namespace mvtp {
namespace {

/// One obstacle on a map of no size: every look-up tries it.
std::shared_ptr<const Obstacles> alone(const Map& map, int obstacle) {
  const int circles = int(map.circles.size());
  Map one{.width = 0.0, .height = 0.0, .circles = {}, .polygons = {}};
  if (obstacle < circles) {
    one.circles = {map.circles[std::size_t(obstacle)]};
  } else {
    one.polygons = {map.polygons[std::size_t(obstacle - circles)]};
  }
  return std::make_shared<Obstacles>(one, 0.0);
}

/// The body without a margin of this width.
Vehicle smaller(Vehicle body, double margin) {
  body.front -= margin;
  body.rear -= margin;
  body.width -= 2 * margin;
  return body;
}

/// The largest body around the same middle that does not hit the obstacle.
Vehicle largest_free(const Vehicle& body, const Obstacles& obstacle, const Pose& pose) {
  constexpr int kHalvings = 30;
  double too_large = 0.0;
  double fits = std::min(body.length(), body.width) / 2;
  for (int k = 0; k < kHalvings; ++k) {
    const double margin = (too_large + fits) / 2;
    (obstacle.hit(Sweep(smaller(body, margin), pose, {})) ? too_large : fits) = margin;
  }
  return smaller(body, fits);
}

}  // namespace

Exemptions::Exemptions(const Vehicle& vehicle, const Map& map, const Obstacles& obstacles,
                       const Pose& start, const Pose& goal)
    : vehicle_(vehicle) {
  add(map, obstacles.all_hits(Sweep(vehicle, start, {})), start, &Exempt::at_start);
  add(map, obstacles.all_hits(Sweep(vehicle, goal, {})), goal, &Exempt::at_goal);
}

void Exemptions::add(const Map& map, const std::vector<int>& hit, const Pose& pose,
                     std::optional<Core> Exempt::*place) {
  for (const int obstacle : hit) {
    const auto known = std::ranges::find(numbers_, obstacle);
    const std::size_t k = std::size_t(known - numbers_.begin());
    if (known == numbers_.end()) {
      numbers_.push_back(obstacle);
      exempt_.push_back({alone(map, obstacle), std::nullopt, std::nullopt});
    }
    exempt_[k].*place = core(map, obstacle, pose);
  }
}

Exemptions::Core Exemptions::core(const Map& map, int obstacle, const Pose& pose) const {
  if (obstacle >= int(map.circles.size())) {
    std::shared_ptr<const Obstacles> whole = alone(map, obstacle);
    const Vehicle body = largest_free(vehicle_, *whole, pose);
    return {std::move(whole), body};
  }
  Map one{.width = 0.0, .height = 0.0, .circles = {map.circles[std::size_t(obstacle)]}};
  Circle& circle = one.circles.front();
  circle.radius = separation(footprint(vehicle_, pose), Point{circle.x, circle.y});
  if (circle.radius <= 0.0) one.circles.clear();  // its middle is in the body
  return {std::make_shared<Obstacles>(one, 0.0), vehicle_};
}

bool Exemptions::allow(const Obstacles& obstacles, const Sweep& sweep, const Pose& from,
                       const Arc& arc) const {
  if (exempt_.empty() || obstacles.hit_but(sweep, numbers_)) return false;
  return std::ranges::all_of(exempt_, [&](const Exempt& e) { return allow(e, from, arc); });
}

bool Exemptions::allow(const Exempt& exempt, const Pose& from, const Arc& arc) const {
  const Obstacles& obstacle = *exempt.obstacle;
  if (!obstacle.hit(Sweep(vehicle_, from, arc))) return true;
  const auto keeps_off = [&](const std::optional<Core>& core, const Pose& pose) {
    return core && obstacle.hit(Sweep(vehicle_, pose, {})) &&
           !core->obstacle->hit(Sweep(core->body, from, arc));
  };
  return keeps_off(exempt.at_start, from) || keeps_off(exempt.at_goal, drive(from, arc));
}

}  // namespace mvtp
