#include "planner/motion/obstacles.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <ranges>
#include <set>
#include <span>

#include "planner/geometry/polygon.hpp"

namespace mvtp {
namespace {

constexpr double kCellSize = 2.0;  // [m]
constexpr double kMaxCells = 4e5;  // huge maps get larger cells

/// The polygon as a box, if it is a rectangle.
std::optional<OrientedBox> rectangle(const Polygon& polygon) {
  constexpr double kRounding = 1e-9;  // [m]
  if (polygon.size() != 4) return std::nullopt;
  const Point& a = polygon[0];
  const Point& b = polygon[1];
  const Point& c = polygon[2];
  const Point& d = polygon[3];
  const bool is_parallelogram =
      std::abs(a.x + c.x - b.x - d.x) <= kRounding && std::abs(a.y + c.y - b.y - d.y) <= kRounding;
  const auto distance = [](const Point& p, const Point& q) {
    return std::hypot(q.x - p.x, q.y - p.y);
  };
  const double length = distance(a, b);
  const double width = distance(b, c);
  const bool has_equal_diagonals = std::abs(distance(a, c) - distance(b, d)) <= kRounding;
  if (!is_parallelogram || !has_equal_diagonals || std::min(length, width) <= kRounding) {
    return std::nullopt;
  }
  return OrientedBox{(a.x + c.x) / 2,      (a.y + c.y) / 2, (b.x - a.x) / length,
                     (b.y - a.y) / length, length / 2,      width / 2};
}

Extent extent_of(const OrientedBox& box) {
  const double dx = box.half_length * std::abs(box.ux) + box.half_width * std::abs(box.uy);
  const double dy = box.half_length * std::abs(box.uy) + box.half_width * std::abs(box.ux);
  return {box.x - dx, box.y - dy, box.x + dx, box.y + dy};
}

Extent extent_of(const Polygon& polygon) {
  const auto [left, right] = std::ranges::minmax(polygon, {}, &Point::x);
  const auto [bottom, top] = std::ranges::minmax(polygon, {}, &Point::y);
  return {left.x, bottom.y, right.x, top.y};
}

}  // namespace

Obstacles::Obstacles(const Map& map, double reach) : circles_(map.circles), reach_(reach) {
  for (std::size_t k = 0; k < map.polygons.size(); ++k) add(map.polygons[k], int(k));

  const double width = map.width + 2 * reach_;
  const double height = map.height + 2 * reach_;
  cell_size_ = std::max(kCellSize, std::sqrt(width * height / kMaxCells));
  columns_ = int(width / cell_size_) + 1;
  rows_ = int(height / cell_size_) + 1;

  // Counting sort of (cell, item) pairs: an item belongs to every cell within its reach.
  const auto for_each_cell = [&](int item, auto&& visitor) {
    const Extent e = item_extent(item);
    const auto clamped = [&](double value, int count) {
      return std::clamp(int(std::clamp(value / cell_size_, -1.0, 1e6)), 0, count - 1);
    };
    // The grid starts at -reach; an item reaches `reach` beyond its extent.
    for (int row = clamped(e.min_y, rows_); row <= clamped(e.max_y + 2 * reach_, rows_); ++row) {
      for (int column = clamped(e.min_x, columns_);
           column <= clamped(e.max_x + 2 * reach_, columns_); ++column) {
        visitor(std::size_t(row * columns_ + column));
      }
    }
  };
  first_.assign(std::size_t(columns_ * rows_) + 1, 0);
  for (int item = 0; item < item_count(); ++item) {
    for_each_cell(item, [&](std::size_t k) { ++first_[k + 1]; });
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  items_.resize(std::size_t(first_.back()));
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (int item = 0; item < item_count(); ++item) {
    for_each_cell(item, [&](std::size_t k) { items_[std::size_t(next[k]++)] = item; });
  }
}

void Obstacles::add(const Polygon& polygon, int index) {
  if (const std::optional<OrientedBox> box = rectangle(polygon)) {
    parts_.push_back({*box, index});
    return;
  }
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    parts_.push_back({segment(polygon[i], polygon[(i + 1) % polygon.size()]), index});
  }
  insides_.push_back({polygon, index});
}

bool Obstacles::hit(const Sweep& sweep) const { return first_hit(sweep) >= 0; }

int Obstacles::first_hit(const Sweep& sweep) const {
  int first = -1;
  any_hit(sweep, [&](int obstacle) {
    first = obstacle;
    return true;
  });
  return first;
}

bool Obstacles::hit_but(const Sweep& sweep, std::span<const int> left_out) const {
  return any_hit(
      sweep, [&](int obstacle) { return std::ranges::find(left_out, obstacle) == left_out.end(); });
}

std::vector<int> Obstacles::all_hits(const Sweep& sweep) const {
  std::set<int> hits;
  any_hit(sweep, [&](int obstacle) {
    hits.insert(obstacle);
    return false;
  });
  return {hits.begin(), hits.end()};
}

template <class Visitor>
bool Obstacles::any_hit(const Sweep& sweep, Visitor&& visitor) const {
  const double column = (sweep.centre().x + reach_) / cell_size_;
  const double row = (sweep.centre().y + reach_) / cell_size_;
  const bool in_grid = column >= 0 && row >= 0 && column < columns_ && row < rows_;
  const auto any_of = [&](const auto& items) {
    if (items.empty()) return false;
    const OrientedBox around = sweep.around();
    for (const int item : items) {
      if (hits_item(sweep, around, item) && visitor(obstacle_of(item))) return true;
    }
    return false;
  };
  if (!in_grid || sweep.radius() > reach_) return any_of(std::views::iota(0, item_count()));
  const std::size_t k = std::size_t(int(row) * columns_ + int(column));
  return any_of(std::span(items_.begin() + first_[k], items_.begin() + first_[k + 1]));
}

Extent Obstacles::item_extent(int item) const {
  std::size_t k = std::size_t(item);
  if (k < circles_.size()) {
    const Circle& c = circles_[k];
    return {c.x - c.radius, c.y - c.radius, c.x + c.radius, c.y + c.radius};
  }
  k -= circles_.size();
  if (k < parts_.size()) return extent_of(parts_[k].box);
  return extent_of(insides_[k - parts_.size()].outline);
}

bool Obstacles::hits_item(const Sweep& sweep, const OrientedBox& around, int item) const {
  std::size_t k = std::size_t(item);
  if (k < circles_.size()) {
    const Circle& c = circles_[k];
    return separation(around, Point{c.x, c.y}) <= c.radius && collide(sweep, {c.x, c.y}, c.radius);
  }
  k -= circles_.size();
  if (k < parts_.size()) {
    return separation(around, parts_[k].box) <= 0.0 && collide(sweep, parts_[k].box);
  }
  // Whoever is inside without touching an edge is inside all the time.
  return contains(insides_[k - parts_.size()].outline, sweep.centre());
}

int Obstacles::obstacle_of(int item) const {
  std::size_t k = std::size_t(item);
  if (k < circles_.size()) return item;
  k -= circles_.size();
  const int polygon = k < parts_.size() ? parts_[k].polygon : insides_[k - parts_.size()].polygon;
  return int(circles_.size()) + polygon;
}

}  // namespace mvtp
