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

/// How far a lane bends at a station, over as much of it as a long vehicle covers [rad].
double bend_at(const std::vector<Point>& line, double s, double length) {
  constexpr double kHalf = 9.0;  // [m]
  constexpr double kStep = 0.5;  // [m] over which a heading is taken
  const double begin = std::max(0.0, s - kHalf);
  const double end = std::min(length, s + kHalf);
  if (end - begin < 2.0 * kStep) return 0.0;
  const double from = heading(point_at(line, begin), point_at(line, begin + kStep));
  const double to = heading(point_at(line, end - kStep), point_at(line, end));
  return std::abs(wrap_to_pi(to - from));
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
  constexpr double kMost = kNear + kSwing;
  const Bounds& own = bounds_[std::size_t(lane)];
  std::vector<int> beside;
  for (int other = 0; other < graph_.lanes(); ++other) {
    const Bounds& b = bounds_[std::size_t(other)];
    const bool may = b.low.x < own.high.x + kMost && own.low.x < b.high.x + kMost &&
                     b.low.y < own.high.y + kMost && own.low.y < b.high.y + kMost;
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
  if (cross(graph_.lane(lane).shape, graph_.lane(other).shape)) return false;
  return comes_near(lane, other) || comes_near(other, lane);
}

/// Does it lead over a junction where drivers look out for those whose paths they cross?
bool LanesBeside::is_looked_over(int lane) const {
  return std::ranges::any_of(graph_.links_over(lane), [this](int k) {
    return graph_.junction(graph_.link(k).junction).has_conflicts;
  });
}

/// Is a place on this lane near to the other one, for how it bends there?
bool LanesBeside::comes_near(int lane, int other) const {
  constexpr double kStep = 0.5;  // [m]
  constexpr double kBend = 0.5;  // [rad]
  const double swing = is_looked_over(lane) || is_looked_over(other) ? 0.0 : kSwing;
  const std::vector<Point>& line = graph_.lane(lane).shape;
  const std::vector<Point>& beside = graph_.lane(other).shape;
  const double length = length_of(line);
  for (double s = 0.0; s < length + kStep; s += kStep) {
    const Point p = point_at(line, std::min(s, length));
    const double apart = distance_to(beside, {p.x, p.y, 0.0});
    if (apart < kNear) return true;
    if (apart < kNear + swing && bend_at(line, s, length) > kBend) return true;
  }
  return false;
}

}  // namespace mvtp
