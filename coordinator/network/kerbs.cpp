#include "coordinator/network/kerbs.hpp"

#include <cmath>

namespace mvtp {
namespace {

/// @param kerb, other  the ends of a crossing's middle
Polygon waiting_place(const Point& kerb, const Point& other, double width) {
  constexpr double kBefore = 0.3;  // [m] of road: bodies reach over the kerb
  constexpr double kBehind = 0.5;  // [m]
  const double length = std::hypot(other.x - kerb.x, other.y - kerb.y);
  const Point u{(other.x - kerb.x) / length, (other.y - kerb.y) / length};
  const auto corner = [&](double along, double aside) {
    return Point{kerb.x + along * u.x - aside * u.y, kerb.y + along * u.y + aside * u.x};
  };
  const double half = width / 2.0;
  return {corner(-kBehind, -half), corner(kBefore, -half), corner(kBefore, half),
          corner(-kBehind, half)};
}

}  // namespace

std::vector<Polygon> kerbs_where_people_wait(const RoadNetwork& network) {
  std::vector<Polygon> places;
  for (const auto& [id, junction] : network.junctions) {
    for (const PedestrianCrossing& crossing : junction.crossings) {
      const Point& one = crossing.shape.front();
      const Point& other = crossing.shape.back();
      places.push_back(waiting_place(one, other, crossing.width));
      places.push_back(waiting_place(other, one, crossing.width));
    }
  }
  return places;
}

}  // namespace mvtp
