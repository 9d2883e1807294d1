#include "coordinator/network/lanes_beside.hpp"

#include <algorithm>

#include "coordinator/network/polyline.hpp"

namespace mvtp {
namespace {

/// Is `p` to the left of the line from `a` to `b`? [m^2], twice the area between them.
double left_of(const Point& a, const Point& b, const Point& p) {
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

bool cross(const std::vector<Point>& one, const std::vector<Point>& other) {
  for (std::size_t i = 1; i < one.size(); ++i) {
    for (std::size_t j = 1; j < other.size(); ++j) {
      const Point &a = one[i - 1], &b = one[i], &c = other[j - 1], &d = other[j];
      if (left_of(a, b, c) * left_of(a, b, d) < 0.0 && left_of(c, d, a) * left_of(c, d, b) < 0.0) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

LanesBeside::LanesBeside(const LaneGraph& graph) : graph_(graph) {
  for (int l = 0; l < graph.lanes(); ++l) {
    const std::vector<Point>& shape = graph.lane(l).shape;
    Bounds& bounds = bounds_.emplace_back(shape.front(), shape.front());
    for (const Point& p : shape) {
      bounds.low = {std::min(bounds.low.x, p.x), std::min(bounds.low.y, p.y)};
      bounds.high = {std::max(bounds.high.x, p.x), std::max(bounds.high.y, p.y)};
    }
  }
}

std::vector<int> LanesBeside::of(int lane) const {
  const std::vector<int> joined = joined_with(lane);
  const Bounds& own = bounds_[std::size_t(lane)];
  std::vector<int> beside;
  for (int other = 0; other < graph_.lanes(); ++other) {
    const Bounds& b = bounds_[std::size_t(other)];
    const bool may = b.low.x < own.high.x + kNear && own.low.x < b.high.x + kNear &&
                     b.low.y < own.high.y + kNear && own.low.y < b.high.y + kNear;
    if (may && other != lane && std::ranges::count(joined, other) == 0 && come_near(lane, other)) {
      beside.push_back(other);
    }
  }
  return beside;
}

/// The lanes of all connections that begin or end where one of those of this lane does.
std::vector<int> LanesBeside::joined_with(int lane) const {
  std::vector<int> links;
  for (const auto& own :
       {graph_.links_from(lane), graph_.links_over(lane), graph_.links_to(lane)}) {
    for (const int k : own) {
      const LaneGraph::Link& link = graph_.link(k);
      for (const int other : graph_.links_from(link.from)) links.push_back(other);
      for (const int other : graph_.links_to(link.to)) links.push_back(other);
    }
  }
  std::vector<int> joined;
  for (const int k : links) {
    const LaneGraph::Link& link = graph_.link(k);
    joined.insert(joined.end(), link.via.begin(), link.via.end());
    joined.insert(joined.end(), {link.from, link.to});
  }
  return joined;
}

bool LanesBeside::come_near(int lane, int other) const {
  constexpr double kStep = 0.5;  // [m]
  const std::vector<Point>& line = graph_.lane(lane).shape;
  const std::vector<Point>& beside = graph_.lane(other).shape;
  if (cross(line, beside)) return false;
  const double length = length_of(line);
  for (double s = 0.0; s < length + kStep; s += kStep) {
    const Point p = point_at(line, std::min(s, length));
    if (distance_to(beside, {p.x, p.y, 0.0}) < kNear) return true;
  }
  return false;
}

}  // namespace mvtp
