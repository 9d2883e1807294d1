#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "planner/problem/pose.hpp"

namespace mvtp {

/// Of two places [m^2].
[[nodiscard]] inline double squared_distance(const Point& a, const Point& b) {
  return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

/// Robots found by place: sorted by x, so that only those in a strip of the map are looked at.
class Neighbours {
 public:
  Neighbours() = default;
  explicit Neighbours(const std::vector<Pose>& q) {
    entries_.reserve(q.size());
    for (int i = 0; i < int(q.size()); ++i) {
      entries_.push_back({q[std::size_t(i)].x, q[std::size_t(i)].y, i});
    }
    std::ranges::sort(entries_, {}, [](const Entry& e) { return std::pair(e.x, e.robot); });
  }

  /// The robots at most `radius` away from `place` [m], from left to right.
  void within(double radius, const Pose& place, std::vector<int>& result) const {
    result.clear();
    const auto first = std::ranges::lower_bound(entries_, place.x - radius, {}, &Entry::x);
    for (auto entry = first; entry != entries_.end() && entry->x <= place.x + radius; ++entry) {
      const double d2 = squared_distance({entry->x, entry->y}, {place.x, place.y});
      if (d2 <= radius * radius) result.push_back(entry->robot);
    }
  }

 private:
  struct Entry {
    double x;
    double y;
    int robot;
  };
  std::vector<Entry> entries_;
};

}  // namespace mvtp
