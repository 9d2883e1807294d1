#include "planner/motion/passages.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

namespace mvtp {
namespace {

Point operator+(const Point& p, const Point& q) { return {p.x + q.x, p.y + q.y}; }
Point operator-(const Point& p, const Point& q) { return {p.x - q.x, p.y - q.y}; }
Point operator*(double s, const Point& p) { return {s * p.x, s * p.y}; }
double dot(const Point& p, const Point& q) { return p.x * q.x + p.y * q.y; }
double cross(const Point& p, const Point& q) { return p.x * q.y - p.y * q.x; }
double length(const Point& p) { return std::hypot(p.x, p.y); }

constexpr double kRounding = 1e-6;  // [m]

/// The point of the segment ab that is closest to p.
Point closest(const Point& a, const Point& b, const Point& p) {
  const double square = dot(b - a, b - a);
  if (square == 0.0) return a;
  return a + std::clamp(dot(p - a, b - a) / square, 0.0, 1.0) * (b - a);
}

/// Does the segment pq pass from one side of the line through a and b to the other? Points on the
/// line count as left of it, so that a closed curve passes an even number of times.
bool changes_side(const Point& a, const Point& b, const Point& p, const Point& q) {
  return (cross(b - a, p - a) >= 0.0) != (cross(b - a, q - a) >= 0.0);
}

/// Where on ab, from 0 at a to 1 at b, the line through p and q crosses. @pre changes_side()
double crossing(const Point& a, const Point& b, const Point& p, const Point& q) {
  return cross(p - a, q - p) / cross(b - a, q - p);
}

/// The closest points of the segments ab and cd.
std::pair<Point, Point> closest_points(const Point& a, const Point& b, const Point& c,
                                       const Point& d) {
  if (changes_side(a, b, c, d)) {
    const double u = crossing(a, b, c, d);
    if (u >= 0.0 && u <= 1.0) return {a + u * (b - a), a + u * (b - a)};
  }
  const std::array<std::pair<Point, Point>, 4> pairs = {
      {{a, closest(c, d, a)}, {b, closest(c, d, b)}, {closest(a, b, c), c}, {closest(a, b, d), d}}};
  return *std::ranges::min_element(
      pairs, {}, [](const auto& pair) { return length(pair.first - pair.second); });
}

/// How often a line crosses the segment between two points: is it odd?
bool crosses_oddly(std::span<const Point> line, const Point& from, const Point& to) {
  bool odd = false;
  for (std::size_t k = 1; k < line.size(); ++k) {
    const Point& p = line[k - 1];
    const Point& q = line[k];
    if (!changes_side(from, to, p, q)) continue;
    const double u = crossing(from, to, p, q);
    if (u > 0.0 && u < 1.0) odd = !odd;
  }
  return odd;
}

/// Disjoint sets whose members know whether the path to their root crosses an odd number of times.
class ParitySets {
 public:
  explicit ParitySets(std::size_t n) : parent_(n), odd_(n, false) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  /// Joins i and j by a line of this parity; false if there was one of the other parity.
  bool join(int i, int j, bool odd) {
    const auto [root_i, odd_i] = find(i);
    const auto [root_j, odd_j] = find(j);
    if (root_i == root_j) return (odd_i != odd_j) == odd;
    parent_[std::size_t(root_j)] = root_i;
    odd_[std::size_t(root_j)] = (odd_i != odd_j) != odd;
    return true;
  }

 private:
  std::pair<int, bool> find(int i) {
    bool odd = false;
    while (parent_[std::size_t(i)] != i) {
      // Path halving: i is hung up under its grandparent.
      const int parent = parent_[std::size_t(i)];
      odd_[std::size_t(i)] = odd_[std::size_t(i)] != odd_[std::size_t(parent)];
      parent_[std::size_t(i)] = parent_[std::size_t(parent)];
      odd = odd != odd_[std::size_t(i)];
      i = parent_[std::size_t(i)];
    }
    return {i, odd};
  }

  std::vector<int> parent_;
  std::vector<bool> odd_;
};

}  // namespace

Passages::Passages(const Map& map, double radius, double outside, const Deadline& deadline) {
  // The centre keeps `radius` from everything: so from a frame that lies as much farther out.
  const double far = outside + radius;
  add_polygon({{-far, -far},
               {map.width + far, -far},
               {map.width + far, map.height + far},
               {-far, map.height + far}});
  for (const Polygon& polygon : map.polygons) add_polygon(polygon);
  for (const Circle& c : map.circles) walls_.push_back({{c.x, c.y}, {c.x, c.y}, c.radius});

  // Sorted by where they begin, so that each meets only those that begin before it ends.
  const auto first_x = [](const Wall& wall) { return std::min(wall.a.x, wall.b.x) - wall.radius; };
  const auto last_x = [](const Wall& wall) { return std::max(wall.a.x, wall.b.x) + wall.radius; };
  std::ranges::stable_sort(walls_, {}, first_x);
  const auto first_y = [](const Wall& wall) { return std::min(wall.a.y, wall.b.y) - wall.radius; };
  const auto last_y = [](const Wall& wall) { return std::max(wall.a.y, wall.b.y) + wall.radius; };
  const double width = 2 * radius + kRounding;
  for (int i = 0; i < int(walls_.size()) && !deadline.expired(); ++i) {
    const Wall& v = walls_[std::size_t(i)];
    const double reach = last_x(v) + 2 * radius;
    const double low = first_y(v) - width;
    const double high = last_y(v) + width;
    for (int j = i + 1; j < int(walls_.size()) && first_x(walls_[std::size_t(j)]) < reach; ++j) {
      const Wall& w = walls_[std::size_t(j)];
      if (last_y(w) >= low && first_y(w) <= high) link(i, j, 2 * radius);
    }
  }
}

void Passages::add_polygon(const Polygon& polygon) {
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    walls_.push_back({polygon[k], polygon[(k + 1) % polygon.size()], 0.0});
  }
}

void Passages::link(int i, int j, double width) {
  const Wall& v = walls_[std::size_t(i)];
  const Wall& w = walls_[std::size_t(j)];
  const auto [on_v, on_w] = closest_points(v.a, v.b, w.a, w.b);
  if (length(on_v - on_w) - v.radius - w.radius >= width) return;
  links_.push_back({i, j, {v.a, on_v, on_w, w.a}});
}

bool Passages::separated(const Point& from, const Point& to) const {
  ParitySets sets(walls_.size());
  return !std::ranges::all_of(links_, [&](const Link& link) {
    return sets.join(link.i, link.j, crosses_oddly(link.line, from, to));
  });
}

}  // namespace mvtp
