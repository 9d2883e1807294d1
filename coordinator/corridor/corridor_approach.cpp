// From how far before a stop line on vehicles are taken over.

#include <algorithm>
#include <limits>
#include <set>
#include <unordered_map>

#include "coordinator/corridor/corridor_course.hpp"
#include "planner/road.hpp"

namespace mvtp {

/// What it takes to be noticed, and to stop, from a speed limit on [m].
double CourseFinder::stopping_room(double limit) const {
  constexpr double kDecision = 0.5;  // [s]
  constexpr double kBraking = 3.5;   // [m/s^2]
  constexpr double kSpare = 10.0;    // [m]
  return limit * (kDecision + options_.latency) + stopping_distance(limit, kBraking) + kSpare;
}

/// Upstream from the end of an edge: the room that the fastest lane needs, of those from which a
/// vehicle still has to stop there.
double CourseFinder::find_takeover(int edge, double furthest) const {
  double takeover = options_.takeover;
  std::unordered_map<int, double> to_line = {{edge, 0.0}};
  std::vector<int> open = {edge};
  while (!open.empty()) {
    const int here = open.back();
    open.pop_back();
    const double distance = to_line.at(here);
    for (const int lane : graph_.lanes_of(here)) {
      const double room = stopping_room(graph_.lane(lane).speed_limit);
      if (room > distance) takeover = std::max(takeover, room);
      for (const int k : graph_.links_to(lane)) {
        const LaneGraph::Link& link = graph_.link(k);
        const int before = graph_.edge_of(link.from);
        const double behind = distance + graph_.lane(lane).length + link.length;
        const bool ends = is_coordinated(link.junction) ||
                          graph_.junction(link.junction).has_conflicts || behind > furthest;
        const auto known = to_line.find(before);
        if (ends || (known != to_line.end() && known->second <= behind)) continue;
        to_line[before] = behind;
        open.push_back(before);
      }
    }
  }
  return takeover;
}

void CourseFinder::find_takeovers() {
  double fastest = 0.0;
  std::set<int> before_lines;
  for (int k = 0; k < graph_.links(); ++k) {
    const LaneGraph::Link& link = graph_.link(k);
    fastest = std::max(fastest, graph_.lane(link.from).speed_limit);
    if (is_coordinated(link.junction)) before_lines.insert(graph_.edge_of(link.from));
  }
  takeover_.assign(std::size_t(graph_.edges()), options_.takeover);
  furthest_ = options_.takeover;
  const double furthest = stopping_room(fastest);
  if (furthest <= options_.takeover) return;  // nobody is so fast
  for (const int edge : before_lines) {
    double& takeover = takeover_[std::size_t(edge)];
    takeover = find_takeover(edge, furthest);
    furthest_ = std::max(furthest_, takeover);
  }
}

/// Backwards from the stop lines, as far as vehicles are taken over.
void CourseFinder::measure_to_lines() {
  to_line_.assign(std::size_t(graph_.lanes()), std::numeric_limits<double>::infinity());
  std::vector<int> open;
  const auto reach = [&](int lane, double distance) {
    const int edge = graph_.edge_of(lane);
    const std::span<const int> beside =
        edge == LaneGraph::kNone ? std::span<const int>(&lane, 1) : graph_.lanes_of(edge);
    for (const int l : beside) {
      if (distance >= to_line_[std::size_t(l)] || distance > furthest_ + kEarly) continue;
      to_line_[std::size_t(l)] = distance;
      open.push_back(l);
    }
  };
  for (int k = 0; k < graph_.links(); ++k) {
    if (is_coordinated(graph_.link(k).junction)) reach(graph_.link(k).from, 0.0);
  }
  while (!open.empty()) {
    const int lane = open.back();
    open.pop_back();
    double distance = to_line_[std::size_t(lane)] + graph_.lane(lane).length;
    for (const int k : graph_.links_to(lane)) {
      const LaneGraph::Link& link = graph_.link(k);
      double behind = distance;
      for (auto via = link.via.rbegin(); via != link.via.rend(); ++via) {
        to_line_[std::size_t(*via)] = std::min(to_line_[std::size_t(*via)], behind);
        behind += graph_.lane(*via).length;
      }
      const bool foreign =
          !is_coordinated(link.junction) && graph_.junction(link.junction).has_conflicts;
      if (!foreign) reach(link.from, behind);
    }
  }
}

bool CourseFinder::may_approach(int lane, double position) const {
  return graph_.lane(lane).length - position + to_line_[std::size_t(lane)] <= furthest_ + kEarly;
}

}  // namespace mvtp
