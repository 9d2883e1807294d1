#include "planner/lot/lot_ground.hpp"

#include <algorithm>
#include <cmath>

#include "planner/geometry/arc.hpp"

namespace mvtp {
namespace {

constexpr double kWallThickness = 0.2;  ///< [m], outside the ground
constexpr double kRoom = 2.0;           ///< [m] around the ground

Polygon quad(const Point& a, const Point& b, double left, double right) {
  const double length = std::hypot(b.x - a.x, b.y - a.y);
  const Point n{-(b.y - a.y) / length, (b.x - a.x) / length};
  return {{a.x - right * n.x, a.y - right * n.y},
          {b.x - right * n.x, b.y - right * n.y},
          {b.x + left * n.x, b.y + left * n.y},
          {a.x + left * n.x, a.y + left * n.y}};
}

double area(const Polygon& polygon) {
  double sum = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point& p = polygon[i];
    const Point& q = polygon[(i + 1) % polygon.size()];
    sum += p.x * q.y - q.x * p.y;
  }
  return sum / 2;
}

bool in_a_slot(const ParkingLot& lot, const Point& p) {
  constexpr double kAround = 0.3;  // [m]
  return std::ranges::any_of(lot.slots, [&](const ParkingSlot& slot) {
    const Pose local = relative(slot.middle, {p.x, p.y, 0.0});
    return std::abs(local.x) < slot.length / 2 + kAround &&
           std::abs(local.y) < slot.width / 2 + kAround;
  });
}

/// Where a footpath leads between two rows of slots no car drives: bars along its middle.
std::vector<Polygon> bars_between_slots(const ParkingLot& lot, const Footpath& path) {
  constexpr double kPiece = 0.5;    // [m]
  constexpr double kBeside = 0.5;   // [m]
  constexpr double kHalfBar = 0.1;  // [m]
  std::vector<Polygon> bars;
  for (std::size_t k = 1; k < path.line.size(); ++k) {
    const Point& a = path.line[k - 1];
    const Point& b = path.line[k];
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    const Pose begin{a.x, a.y, std::atan2(b.y - a.y, b.x - a.x)};
    for (double s = 0.0; s + kPiece <= length; s += kPiece) {
      const auto beside = [&](double side) {
        const double away = side * (path.width / 2 + kBeside);
        const Pose p = compose(begin, {s + kPiece / 2, away, 0.0});
        return in_a_slot(lot, {p.x, p.y});
      };
      if (!beside(1.0) || !beside(-1.0)) continue;
      const Pose from = compose(begin, {s, 0.0, 0.0});
      const Pose to = compose(begin, {s + kPiece, 0.0, 0.0});
      bars.push_back(quad({from.x, from.y}, {to.x, to.y}, kHalfBar, kHalfBar));
    }
  }
  return bars;
}

}  // namespace

Polygon strip(const LotLane& lane, double from, double to) {
  constexpr double kHalfWidth = 1.2;  // [m]
  const Pose begin = drive(lane.begin, Arc{from, 0.0});
  const Pose end = drive(lane.begin, Arc{to, 0.0});
  return quad({begin.x, begin.y}, {end.x, end.y}, kHalfWidth, kHalfWidth);
}

Polygon entry_strip(const LotLane& lane) {
  constexpr double kBeyond = 0.5;  // [m]
  return strip(lane, 0.0, lane.length + kBeyond);
}

Map entry_strips(const ParkingLot& lot, const Map& size) {
  Map map{.width = size.width, .height = size.height};
  for (const LotLane& lane : lot.entries) map.polygons.push_back(entry_strip(lane));
  return map;
}

Map walls_of(const ParkingLot& lot) {
  Map map;
  const bool turns_left = area(lot.ground) > 0.0;
  for (std::size_t i = 0; i < lot.ground.size(); ++i) {
    const Point& a = lot.ground[i];
    const Point& b = lot.ground[(i + 1) % lot.ground.size()];
    map.width = std::max(map.width, a.x + kRoom);
    map.height = std::max(map.height, a.y + kRoom);
    map.polygons.push_back(
        quad(a, b, turns_left ? 0.0 : kWallThickness, turns_left ? kWallThickness : 0.0));
  }
  map.polygons.insert(map.polygons.end(), lot.obstacles.begin(), lot.obstacles.end());
  for (const Footpath& path : lot.footpaths) {
    const std::vector<Polygon> bars = bars_between_slots(lot, path);
    map.polygons.insert(map.polygons.end(), bars.begin(), bars.end());
  }
  return map;
}

Polygon outline(const StandingCar& car) {
  Polygon result;
  const double half = car.body.width / 2;
  for (const Point& p : {Point{car.body.front, half}, Point{-car.body.rear, half},
                         Point{-car.body.rear, -half}, Point{car.body.front, -half}}) {
    const Pose corner = compose(car.pose, {p.x, p.y, 0.0});
    result.push_back({corner.x, corner.y});
  }
  return result;
}

}  // namespace mvtp
