#include "coordinator/prediction/watched_lanes.hpp"

#include <algorithm>

namespace mvtp {

WatchedLanes::WatchedLanes(const LaneGraph& graph, const CourseFinder& finder)
    : graph_(graph),
      beside_(graph),
      watched_(std::size_t(graph.lanes()), false),
      driven_(std::size_t(graph.lanes()), false) {
  for (int k = 0; k < graph.links(); ++k) {
    const LaneGraph::Link& link = graph.link(k);
    if (!finder.is_coordinated(link.junction)) continue;
    watched_[std::size_t(link.from)] = watched_[std::size_t(link.to)] = true;
    for (const int via : link.via) watched_[std::size_t(via)] = true;
  }
}

void WatchedLanes::add(const Corridor& corridor) {
  for (const CorridorPiece& piece : corridor.course.pieces) {
    add_driven(piece.lane);
    add_driven(piece.last_lane());
  }
}

void WatchedLanes::add_driven(int lane) {
  constexpr double kComing = 60.0;  // [m] before they come near
  if (driven_[std::size_t(lane)]) return;
  driven_[std::size_t(lane)] = watched_[std::size_t(lane)] = true;
  for (const int other : beside_.of(lane)) add_up_to(other, kComing);
}

/// A lane, and `before` metres of those from where vehicles come onto it.
void WatchedLanes::add_up_to(int lane, double before) {
  watched_[std::size_t(lane)] = true;
  if (before <= 0.0) return;
  const auto go_back = [&](int from) {
    add_up_to(from, before - std::max(1.0, graph_.lane(from).length));
  };
  for (const int k : graph_.links_over(lane)) go_back(graph_.link(k).from);
  for (const int k : graph_.links_to(lane)) {
    for (const int via : graph_.link(k).via) watched_[std::size_t(via)] = true;
    go_back(graph_.link(k).from);
  }
}

}  // namespace mvtp
