#include "coordinator/prediction/watched_lanes.hpp"

#include <algorithm>

namespace mvtp {

WatchedLanes::WatchedLanes(const LaneGraph& graph, const CourseFinder& finder)
    : graph_(graph),
      beside_(graph),
      watched_(std::size_t(graph.lanes()), false),
      driven_(std::size_t(graph.lanes()), false),
      is_beside_(std::size_t(graph.lanes()), false) {
  for (int k = 0; k < graph.links(); ++k) {
    const LaneGraph::Link& link = graph.link(k);
    if (!finder.is_coordinated(link.junction)) continue;
    watched_[std::size_t(link.to)] = true;
    for (const int via : link.via) watched_[std::size_t(via)] = true;
  }
  // Who is let over a junction is let go from as far off as others are taken over, however many
  // short lanes that is.
  for (int l = 0; l < graph.lanes(); ++l) {
    if (finder.may_approach(l, graph.lane(l).length)) watched_[std::size_t(l)] = true;
  }
}

void WatchedLanes::add(const Corridor& corridor) {
  for (const CorridorPiece& piece : corridor.course.pieces) {
    add_driven(piece.lane);
    add_driven(piece.last_lane());
  }
}

void WatchedLanes::add_driven(int lane) {
  constexpr double kComing = 60.0;   // [m] before they come near
  constexpr double kLeading = 60.0;  // [m] behind that: whom they follow
  if (driven_[std::size_t(lane)]) return;
  driven_[std::size_t(lane)] = watched_[std::size_t(lane)] = true;
  for (const int other : beside_.of(lane)) {
    is_beside_[std::size_t(other)] = true;
    add_along(other, Side::kBefore, kComing);
    add_along(other, Side::kBehind, kLeading);
  }
}

/// A lane, and `room` metres of those before it, from where vehicles come, or behind it.
void WatchedLanes::add_along(int lane, Side side, double room) {
  watched_[std::size_t(lane)] = true;
  if (room <= 0.0) return;
  const bool before = side == Side::kBefore;
  for (const auto& links :
       {graph_.links_over(lane), before ? graph_.links_to(lane) : graph_.links_from(lane)}) {
    for (const int k : links) {
      const LaneGraph::Link& link = graph_.link(k);
      for (const int via : link.via) watched_[std::size_t(via)] = true;
      const int next = before ? link.from : link.to;
      add_along(next, side, room - std::max(1.0, graph_.lane(next).length));
    }
  }
}

}  // namespace mvtp
