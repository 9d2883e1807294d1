#include "planner/motion/passages.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "planner/geometry/polygon.hpp"
#include "planner/motion/obstacles.hpp"

namespace mvtp {
namespace {

/// A fine grid over a square map, as a second opinion: is there a path of the disc's centre over
/// cells whose middle keeps `clearance` from every obstacle?
class Flood {
 public:
  static constexpr double kSide = 0.2;

  Flood(const Map& map, double clearance)
      : n_(int(map.width / kSide)), reached_(std::size_t(n_ * n_), 0) {
    for (int k = 0; k < n_ * n_; ++k) {
      if (distance_to_obstacles(map, middle(k)) < clearance) reached_[std::size_t(k)] = -1;
    }
  }

  [[nodiscard]] bool free(const Point& p) const { return reached_[cell(p)] >= 0; }

  [[nodiscard]] bool connects(const Point& from, const Point& to) {
    std::ranges::replace(reached_, 1, 0);
    std::vector<int> open = {int(cell(from))};
    reached_[cell(from)] = 1;
    while (!open.empty()) {
      const int k = open.back();
      open.pop_back();
      for (const int d : {-1, 1, -n_, n_, -n_ - 1, -n_ + 1, n_ - 1, n_ + 1}) {
        const int next = k + d;
        if (next < 0 || next >= n_ * n_ || std::abs(next % n_ - k % n_) > 1) continue;
        if (reached_[std::size_t(next)] != 0) continue;
        reached_[std::size_t(next)] = 1;
        open.push_back(next);
      }
    }
    return reached_[cell(to)] == 1;
  }

  [[nodiscard]] static double distance_to_obstacles(const Map& map, const Point& p) {
    double distance = std::min({p.x, p.y, map.width - p.x, map.height - p.y});
    for (const Circle& c : map.circles) {
      distance = std::min(distance, std::hypot(p.x - c.x, p.y - c.y) - c.radius);
    }
    for (const Polygon& polygon : map.polygons) {
      if (contains(polygon, p)) return -1.0;
      for (std::size_t k = 0; k < polygon.size(); ++k) {
        const OrientedBox edge = segment(polygon[k], polygon[(k + 1) % polygon.size()]);
        distance = std::min(distance, separation(edge, p));
      }
    }
    return distance;
  }

 private:
  [[nodiscard]] Point middle(int k) const {
    return {(k % n_ + 0.5) * kSide, (k / n_ + 0.5) * kSide};
  }
  [[nodiscard]] std::size_t cell(const Point& p) const {
    return std::size_t(int(p.y / kSide) * n_ + int(p.x / kSide));
  }

  int n_;
  std::vector<int> reached_;  ///< -1 blocked, 0 not reached, 1 reached
};

Map random_map(unsigned seed) {
  std::mt19937_64 rng(seed);
  const auto in = [&rng](double low, double high) {
    return low + (high - low) * double(rng() >> 11U) * 0x1p-53;
  };
  Map map{.width = 20, .height = 20, .circles = {}, .polygons = {}};
  for (int k = 0; k < 5; ++k) map.circles.push_back({in(0, 20), in(0, 20), in(0.2, 1.2)});
  for (int k = 0; k < 7; ++k) {  // long walls
    const Point at{in(0, 20), in(0, 20)};
    const double angle = in(0, 6);
    const double length = in(8, 20);
    const double dx = std::cos(angle);
    const double dy = std::sin(angle);
    map.polygons.push_back({at,
                            {at.x + length * dx, at.y + length * dy},
                            {at.x + length * dx - 0.3 * dy, at.y + length * dy + 0.3 * dx},
                            {at.x - 0.3 * dy, at.y + 0.3 * dx}});
  }
  return map;
}

//   A cell reaches 0.1414 m around its middle: keeping that much more clearance, neighbours are
//   joined for certain; that much less, a real path passes over free cells only.
TEST(Passages, AgreeWithAFineGrid) {
  constexpr double kRadius = 0.9;
  constexpr double kCell = 0.5 * Flood::kSide * std::numbers::sqrt2;
  int open = 0;
  int closed = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Map map = random_map(seed);
    const Passages passages(map, kRadius, -kRadius);
    Flood surely(map, kRadius + 2 * kCell);
    Flood perhaps(map, kRadius - 2 * kCell);
    std::mt19937_64 rng(seed + 1000);
    for (int k = 0; k < 40; ++k) {
      const Point from{1 + double(rng() % 180) / 10, 1 + double(rng() % 180) / 10};
      const Point to{1 + double(rng() % 180) / 10, 1 + double(rng() % 180) / 10};
      if (!surely.free(from) || !surely.free(to)) continue;
      if (surely.connects(from, to)) {
        EXPECT_FALSE(passages.separated(from, to)) << seed;
        ++open;
      } else if (!perhaps.connects(from, to)) {
        EXPECT_TRUE(passages.separated(from, to)) << seed;
        ++closed;
      }
    }
  }
  EXPECT_GT(open, 100);
  EXPECT_GT(closed, 50);
}

Map ring(int circles, double radius) {
  Map map{.width = 40, .height = 40, .circles = {}, .polygons = {}};
  for (int k = 0; k < circles; ++k) {
    const double angle = 2 * std::numbers::pi * k / circles;
    map.circles.push_back({20 + 10 * std::cos(angle), 20 + 10 * std::sin(angle), radius});
  }
  return map;
}

//   24 discs of 0.3 m on a circle: 2.01 m between neighbours.
TEST(Passages, ARingIsClosedForADiscWiderThanItsGaps) {
  const double gap = 2 * 10 * std::sin(std::numbers::pi / 24) - 2 * 0.3;
  for (const double radius : {gap / 2 - 0.001, gap / 2 + 0.001}) {
    const Passages passages(ring(24, 0.3), radius, -radius);
    EXPECT_EQ(passages.separated({20, 20}, {3, 3}), radius > gap / 2);
    EXPECT_FALSE(passages.separated({20, 20}, {24, 17}));  // both inside
    EXPECT_FALSE(passages.separated({3, 3}, {37, 37}));    // both outside, the ring between them
  }
}

TEST(Passages, ACornerIsCutOffOnlyForThoseWhoMayNotLeaveTheMap) {
  Map map{.width = 20, .height = 20, .circles = {}, .polygons = {}};
  map.polygons = {{{0, 8}, {8, 0}, {8.5, 0.5}, {0.5, 8.5}}};
  EXPECT_TRUE(Passages(map, 1.0, -1.0).separated({2, 2}, {18, 18}));
  EXPECT_TRUE(Passages(map, 1.0, 0.9).separated({2, 2}, {18, 18}));
  EXPECT_FALSE(Passages(map, 1.0, 1.5).separated({2, 2}, {18, 18}));
}

TEST(Passages, WithoutTimeNothingIsProven) {
  Map map{.width = 30, .height = 30};
  map.polygons = {{{14, 0}, {15, 0}, {15, 30}, {14, 30}}};
  EXPECT_TRUE(Passages(map, 1.0, -1.0).separated({5, 15}, {25, 15}));
  EXPECT_FALSE(Passages(map, 1.0, -1.0, Deadline::in(0)).separated({5, 15}, {25, 15}));
}

TEST(Passages, NothingIsSeparatedFromItself) {
  const Passages passages(ring(24, 0.3), 2.0, -2.0);
  EXPECT_FALSE(passages.separated({20, 20}, {20, 20}));
}

}  // namespace
}  // namespace mvtp
