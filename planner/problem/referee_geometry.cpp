#include "planner/problem/referee_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace mvtp::referee {
namespace {

double dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y; }
/// Turned by a right angle to the left.
Point left(const Point& a) { return {-a.y, a.x}; }

/// Half the extent of the box along the unit vector n.
double half_extent(const Box& box, const Point& n) {
  return box.half_length * std::abs(dot(box.heading, n)) +
         box.half_width * std::abs(dot(left(box.heading), n));
}

/// Equal discs in a row that cover a box. It is cut across into equal pieces, about as long as
/// wide, and each disc is the one around a piece.
struct Row {
  int count;
  double radius;
  Point first;  ///< the middle of the first disc
  Point step;   ///< to that of the next
};

Row cover(const Box& box) {
  constexpr double kMost = 8.0;
  const bool is_long = box.half_length > box.half_width;
  const int count = is_long ? int(std::min(std::ceil(box.half_length / box.half_width), kMost)) : 1;
  const double half_piece = box.half_length / count;
  const double back = box.half_length - half_piece;
  return {count,
          std::hypot(half_piece, box.half_width),
          {box.center.x - back * box.heading.x, box.center.y - back * box.heading.y},
          {2.0 * half_piece * box.heading.x, 2.0 * half_piece * box.heading.y}};
}

}  // namespace

Box footprint(const Vehicle& vehicle, const Pose& pose) {
  const Point heading{std::cos(pose.theta), std::sin(pose.theta)};
  const double ahead = 0.5 * (vehicle.front - vehicle.rear);
  return {{pose.x + ahead * heading.x, pose.y + ahead * heading.y},
          heading,
          0.5 * vehicle.length(),
          0.5 * vehicle.width};
}

double reach(const Vehicle& vehicle) {
  const double along = std::max(std::abs(vehicle.front), std::abs(vehicle.rear));
  return std::hypot(along, 0.5 * vehicle.width);
}

double distance_of_covers(const Box& a, const Box& b) {
  const Row p = cover(a);
  const Row q = cover(b);
  double squared = std::numeric_limits<double>::infinity();
  for (int i = 0; i < p.count; ++i) {
    for (int j = 0; j < q.count; ++j) {
      const double x = p.first.x - q.first.x + i * p.step.x - j * q.step.x;
      const double y = p.first.y - q.first.y + i * p.step.y - j * q.step.y;
      squared = std::min(squared, x * x + y * y);
    }
  }
  return std::sqrt(squared) - p.radius - q.radius;
}

std::vector<std::pair<std::size_t, std::size_t>> near_pairs(const std::vector<Disc>& discs) {
  const auto begin = [&](std::size_t i) { return discs[i].center.x - discs[i].radius; };
  std::vector<std::size_t> order(discs.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return std::pair(begin(i), i) < std::pair(begin(j), j);
  });
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t a = 0; a < order.size(); ++a) {
    const double end = discs[order[a]].center.x + discs[order[a]].radius;
    for (std::size_t b = a + 1; b < order.size() && begin(order[b]) <= end; ++b) {
      if (overlap(discs[order[a]], discs[order[b]])) {
        pairs.emplace_back(std::minmax(order[a], order[b]));
      }
    }
  }
  return pairs;
}

DiscsByX::DiscsByX(std::vector<Disc> discs) : discs_(std::move(discs)) {
  for (std::size_t i = 0; i < discs_.size(); ++i) {
    order_.emplace_back(discs_[i].center.x, i);
    largest_ = std::max(largest_, discs_[i].radius);
  }
  std::sort(order_.begin(), order_.end());
}

const std::vector<std::size_t>& DiscsByX::near(const Disc& disc) {
  near_.clear();
  const double reach = disc.radius + largest_;
  const std::pair first(disc.center.x - reach, std::size_t{0});
  for (auto next = std::lower_bound(order_.begin(), order_.end(), first);
       next != order_.end() && next->first <= disc.center.x + reach; ++next) {
    if (overlap(disc, discs_[next->second])) near_.push_back(next->second);
  }
  std::sort(near_.begin(), near_.end());
  return near_;
}

DiscsByX discs_of_obstacles(const Map& map) {
  std::vector<Disc> discs;
  for (const Circle& circle : map.circles) discs.push_back({{circle.x, circle.y}, circle.radius});
  for (const Polygon& polygon : map.polygons) {
    const auto [left, right] = std::ranges::minmax(polygon, {}, &Point::x);
    const auto [bottom, top] = std::ranges::minmax(polygon, {}, &Point::y);
    discs.push_back({{(left.x + right.x) / 2, (bottom.y + top.y) / 2},
                     std::hypot(right.x - left.x, top.y - bottom.y) / 2});
  }
  return DiscsByX(std::move(discs));
}

double margin_inside(const Map& map, const Box& box) {
  const double half_x = half_extent(box, {1.0, 0.0});
  const double half_y = half_extent(box, {0.0, 1.0});
  return std::min({box.center.x - half_x, map.width - box.center.x - half_x, box.center.y - half_y,
                   map.height - box.center.y - half_y});
}

double margin_inside(const Map& map, const Point& point) {
  return std::min({point.x, map.width - point.x, point.y, map.height - point.y});
}

bool contains(const Polygon& polygon, const Point& point) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Point& a = polygon[i];
    const Point& b = polygon[j];
    if ((a.y > point.y) == (b.y > point.y)) continue;
    const double x = a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x);
    if (point.x < x) inside = !inside;
  }
  return inside;
}

Arc joining_arc(const Pose& from, const Pose& to) {
  const Pose step = relative(from, to);
  const double half_turn = 0.5 * step.theta;
  const double chord = step.x * std::cos(half_turn) + step.y * std::sin(half_turn);
  const double length =
      std::abs(half_turn) < 1e-9 ? chord : chord * half_turn / std::sin(half_turn);
  if (length == 0.0) return {};
  return {length, step.theta / length};
}

}  // namespace mvtp::referee
