#include "coordinator/network/crossing_paths.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace mvtp {
namespace {

constexpr double kBehind = 3.0;  ///< [m] of path behind the other kerb, at least
constexpr double kStep = 0.2;    ///< [m] between the places aside at which people stand
/// Half of what somebody covers along his path [m]. With the margins of the planner, those who walk
/// have half a metre around them, those who come to the kerb a tenth: SUMO's people cut the corner
/// before they stand.
constexpr double kWalker = 0.3;
constexpr double kComer = 0.06;
/// Those who stand see the vehicle: less of the margin is theirs, so that a bus that keeps to its
/// lane passes those at its kerb.
constexpr double kStander = 0.18;
constexpr double kNotTheirs = 0.4;
constexpr double kShoulders = 0.26;  ///< half of what somebody covers across it
/// [m] from the sides of a crossing that those may stand who are walked around, if the person stays
/// in its middle; he may keep as far to either side of that.
constexpr double kSqueeze = 1.0;
constexpr double kInside = 0.4;  ///< [m] from its sides that the margins make up for

/// Nobody needs more than a step to stop.
Vehicle box(double along, double across) {
  Vehicle person;
  person.front = along;
  person.rear = along;
  person.width = 2.0 * across;
  person.max_speed = 2.0;
  person.max_accel = 2.0;
  person.max_decel = 4.0;
  return person;
}

/// @param half  of the width of the crossing, without what the margins make up for [m].
Vehicle body(CrossingPaths::Room room, double half) {
  switch (room) {
    case CrossingPaths::Room::kWalks:
      return box(kWalker, half);
    case CrossingPaths::Room::kSqueezes:
      return box(kWalker, std::max(kShoulders, half - kSqueeze));
    case CrossingPaths::Room::kComes:
      return box(kComer, half);
    case CrossingPaths::Room::kStands:
      break;
  }
  return box(kStander, kShoulders);
}

}  // namespace

ReferencePath CrossingPaths::line(int crossing, bool forward, double aside) const {
  std::vector<Point> points = graph_.crossing(crossing).crossing->shape;
  if (!forward) std::ranges::reverse(points);
  const auto away = [](const Point& from, const Point& to, double d) {
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    return Point{to.x + (to.x - from.x) / length * d, to.y + (to.y - from.y) / length * d};
  };
  const double length = graph_.crossing(crossing).length;
  const double whole = std::ceil(length / ReferencePath::kSpacing) * ReferencePath::kSpacing;
  const Point begin = away(points[1], points[0], kKerb);
  const Point end = away(points[points.size() - 2], points.back(), kBehind + whole - length);
  points.insert(points.begin(), begin);
  points.push_back(end);
  const double theta = std::atan2(points[2].y - points[1].y, points[2].x - points[1].x);
  for (Point& p : points) {
    p.x -= aside * std::sin(theta);
    p.y += aside * std::cos(theta);
  }
  return ReferencePath(points);
}

int CrossingPaths::path(int crossing, bool forward, Room room, double aside) {
  if (room == Room::kSqueezes) aside = std::clamp(aside, -kSqueeze, kSqueeze);
  const bool has_place = room == Room::kStands || room == Room::kSqueezes;
  const int steps = has_place ? int(std::lround(aside / kStep)) : 0;
  const auto [found, is_new] = paths_.try_emplace({crossing, forward, room, steps});
  if (!is_new) return found->second;
  const double half = graph_.crossing(crossing).crossing->width / 2.0 - kInside;
  Margins margins = library_.margins();
  if (room == Room::kStands) margins.along -= kNotTheirs;
  return found->second =
             library_.add(line(crossing, forward, steps * kStep), body(room, half), margins);
}

double CrossingPaths::end(int crossing, bool forward) {
  return library_.path(path(crossing, forward, Room::kWalks)).length();
}

CrossingPaths::Place CrossingPaths::place(int crossing, bool forward, bool is_on_it,
                                          const Point& p) {
  const ReferencePath& along = library_.path(path(crossing, forward, Room::kWalks));
  Place place;
  if (is_on_it) {
    place.s = along.project(p, 0.0, along.length());
    place.aside = relative(along.at(place.s), {p.x, p.y, 0.0}).y;
    return place;
  }
  const Pose seen = relative(along.at(kKerb), {p.x, p.y, 0.0});
  const double half = graph_.crossing(crossing).crossing->width / 2.0;
  const double beside = std::max(0.0, std::abs(seen.y) - half);
  place.s = kKerb - std::hypot(std::min(0.0, seen.x), beside);
  place.aside = seen.y;
  return place;
}

bool CrossingPaths::starts_forward(int crossing, const Point& p) const {
  const std::vector<Point>& shape = graph_.crossing(crossing).crossing->shape;
  return std::hypot(shape.front().x - p.x, shape.front().y - p.y) <=
         std::hypot(shape.back().x - p.x, shape.back().y - p.y);
}

bool CrossingPaths::heads_forward(int crossing, double theta) const {
  const std::vector<Point>& shape = graph_.crossing(crossing).crossing->shape;
  return (shape.back().x - shape.front().x) * std::cos(theta) +
             (shape.back().y - shape.front().y) * std::sin(theta) >=
         0.0;
}

}  // namespace mvtp
