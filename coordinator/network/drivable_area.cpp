#include "coordinator/network/drivable_area.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "coordinator/network/polyline.hpp"
#include "planner/problem/referee_geometry.hpp"

namespace mvtp {
namespace {

constexpr double kCell = 8.0;          ///< [m] of the look-up grid
constexpr double kMaxTolerance = 1.0;  ///< [m] that queries may ask for

/// @pre the line has a point
Point nearest(const Point& p, std::span<const Point> line) {
  Point best = line.front();
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Point here = nearest(p, line[i - 1], line[i]);
    if (distance(p, here) < distance(p, best)) best = here;
  }
  return best;
}

/// Is `p` at most `reach` away from the segment? Without a root: this is what footprints are tested
/// with.
bool is_near(const Point& p, const Point& a, const Point& b, double reach) {
  const Point q = nearest(p, a, b);
  const double x = p.x - q.x;
  const double y = p.y - q.y;
  return x * x + y * y <= reach * reach;
}

bool near_border(const Point& p, const Polygon& polygon, double tolerance) {
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    if (is_near(p, polygon[i], polygon[j], tolerance)) return true;
  }
  return false;
}

}  // namespace

DrivableArea::DrivableArea(const RoadNetwork& network, std::span<const ParkingLot> lots,
                           const std::string& vehicle_class, const InterruptionPoint& point) {
  const auto is_open = [&](const Lane& lane) {
    return lane.road || (!vehicle_class.empty() && lane.allows(vehicle_class));
  };
  for (const auto& [id, lane] : network.lanes) {
    point();
    if (is_open(lane)) add_lane(lane);
  }
  for (const auto& [id, lanes] : network.edges) {
    for (std::size_t i = 1; i < lanes.size(); ++i) {
      const Lane& right = network.lanes.at(lanes[i - 1]);
      const Lane& left = network.lanes.at(lanes[i]);
      if (is_open(right) && is_open(left)) add_seam(right, left);
    }
  }
  for (const auto& [id, junction] : network.junctions) {
    if (junction.shape.size() >= 3) add_polygon(junction.shape);
  }
  for (const ParkingLot& lot : lots) {
    add_polygon(lot.ground);
    solid_.insert(solid_.end(), lot.obstacles.begin(), lot.obstacles.end());
  }
}

/// Cell by cell along it: the box around a long strip is mostly empty, and grows with its square.
void DrivableArea::add_strip(const Strip& strip) {
  const auto& [a, b, r] = strip;
  strips_.push_back(strip);
  const auto pieces = std::max<std::int64_t>(1, std::int64_t(std::ceil(distance(a, b) / kCell)));
  const auto point = [&](std::int64_t i) {
    if (i == pieces) return b;
    const double share = double(i) / double(pieces);
    return Point{a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
  };
  for (std::int64_t i = 0; i < pieces; ++i) {
    const Point p = point(i);
    const Point q = point(i + 1);
    register_box({std::min(p.x, q.x) - r, std::min(p.y, q.y) - r},
                 {std::max(p.x, q.x) + r, std::max(p.y, q.y) + r},
                 std::int32_t(strips_.size()) - 1);
  }
}

void DrivableArea::add_lane(const Lane& lane) {
  for (std::size_t i = 1; i < lane.shape.size(); ++i) {
    add_strip({lane.shape[i - 1], lane.shape[i], lane.width / 2.0});
  }
}

/// Lanes of one edge lie a line's width apart, which is as much road as they are.
void DrivableArea::add_seam(const Lane& right, const Lane& left) {
  constexpr double kWidest = 0.5;  // [m]: more is no seam
  std::optional<Strip> before;
  for (const Point& p : right.shape) {
    const Point q = nearest(p, left.shape);
    const double apart = distance(p, q);
    const double gap = apart - (right.width + left.width) / 2.0;
    const double share = (right.width + gap) / 2.0 / apart;
    const Point middle{p.x + share * (q.x - p.x), p.y + share * (q.y - p.y)};
    const bool is_seam = gap > 0.0 && gap < kWidest;
    if (before && is_seam) {
      add_strip({before->a, middle, std::max(before->half_width, gap / 2.0)});
    }
    before = is_seam ? std::optional<Strip>({middle, middle, gap / 2.0}) : std::nullopt;
  }
}

void DrivableArea::add_polygon(const Polygon& polygon) {
  Point low = polygon[0];
  Point high = low;
  for (const Point& p : polygon) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  polygons_.push_back(polygon);
  register_box(low, high, -std::int32_t(polygons_.size()));
}

std::int64_t DrivableArea::cell_key(std::int64_t column, std::int64_t row) {
  return column * (std::int64_t{1} << 31) + row;
}

std::size_t DrivableArea::entries() const {
  std::size_t count = 0;
  for (const auto& [key, items] : cells_) count += items.size();
  return count;
}

/// Boxes of one item come one after the other.
void DrivableArea::register_box(Point low, Point high, std::int32_t item) {
  const auto index = [](double x) { return std::int64_t(std::floor(x / kCell)); };
  for (auto c = index(low.x - kMaxTolerance); c <= index(high.x + kMaxTolerance); ++c) {
    for (auto r = index(low.y - kMaxTolerance); r <= index(high.y + kMaxTolerance); ++r) {
      std::vector<std::int32_t>& items = cells_[cell_key(c, r)];
      if (items.empty() || items.back() != item) items.push_back(item);
    }
  }
}

bool DrivableArea::contains(const Point& p, double tolerance) const {
  std::int32_t item = 0;
  return contains(p, tolerance, item);
}

bool DrivableArea::is_in(std::int32_t item, const Point& p, double tolerance) const {
  if (item >= 0) {
    const Strip& s = strips_[std::size_t(item)];
    return is_near(p, s.a, s.b, s.half_width + tolerance);
  }
  const Polygon& polygon = polygons_[std::size_t(-1 - item)];
  return referee::contains(polygon, p) || near_border(p, polygon, tolerance);
}

bool DrivableArea::contains(const Point& p, double tolerance, std::int32_t& item) const {
  if (item >= 0 && std::size_t(item) < strips_.size() && is_in(item, p, tolerance)) return true;
  const auto cell = cells_.find(
      cell_key(std::int64_t(std::floor(p.x / kCell)), std::int64_t(std::floor(p.y / kCell))));
  if (cell == cells_.end()) return false;
  for (const std::int32_t there : cell->second) {
    if (!is_in(there, p, tolerance)) continue;
    item = there;
    return true;
  }
  return false;
}

bool DrivableArea::touches_solid(const Pose& rear_axle, const Vehicle& body) const {
  constexpr double kTouch = 1e-3;  // [m] that count as no contact
  const Point low{-body.rear + kTouch, -body.width / 2.0 + kTouch};
  const Point high{body.front - kTouch, body.width / 2.0 - kTouch};
  const auto local = [&](const Point& p) {
    const Pose q = relative(rear_axle, {p.x, p.y, 0.0});
    return Point{q.x, q.y};
  };
  // Does a side cross the rectangle (Liang & Barsky 1984)? A body inside a solid without touching
  // its border has crossed that border before.
  const auto crosses = [&](const Point& a, const Point& b) {
    double from = 0.0;
    double to = 1.0;
    const auto clip = [&](double start, double step, double lower, double upper) {
      if (step == 0.0) return start > lower && start < upper;
      from = std::max(from, std::min((lower - start) / step, (upper - start) / step));
      to = std::min(to, std::max((lower - start) / step, (upper - start) / step));
      return from < to;
    };
    return clip(a.x, b.x - a.x, low.x, high.x) && clip(a.y, b.y - a.y, low.y, high.y);
  };
  return std::ranges::any_of(solid_, [&](const Polygon& polygon) {
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
      if (crosses(local(polygon[j]), local(polygon[i]))) return true;
    }
    return false;
  });
}

double DrivableArea::share_outside(const Pose& rear_axle, const Vehicle& body,
                                   double tolerance) const {
  if (touches_solid(rear_axle, body)) return 1.0;
  const double half = body.width / 2.0;
  const int along = std::max(2, int(std::ceil(body.length())));
  const double c = std::cos(rear_axle.theta);
  const double s = std::sin(rear_axle.theta);
  std::int32_t item = 0;  // neighbours on the border are mostly on one strip
  const auto outside = [&](double x, double y) {
    const Point p{rear_axle.x + c * x - s * y, rear_axle.y + s * x + c * y};
    return contains(p, tolerance, item) ? 0 : 1;
  };
  int count = outside(-body.rear, 0.0);
  for (const double y : {half, -half}) {
    for (int i = 0; i <= along; ++i) count += outside(-body.rear + body.length() * i / along, y);
  }
  count += outside(body.front, 0.0);
  return double(count) / double(2 * (along + 1) + 2);
}

}  // namespace mvtp
