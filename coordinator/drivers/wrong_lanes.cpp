#include "coordinator/drivers/wrong_lanes.hpp"

#include <algorithm>
#include <utility>

namespace mvtp {
namespace {

constexpr double kStanding = 0.1;  ///< [m/s]
constexpr double kNearEnd = 20.0;  ///< [m] that drivers leave to those who want into their lane

}  // namespace

WrongLanes::WrongLanes(Traffic& traffic, const LaneGraph& graph, IsControlled is_controlled)
    : traffic_(traffic), graph_(graph), is_controlled_(std::move(is_controlled)) {}

bool WrongLanes::stands_at_end(const VehicleState& v, int lane) const {
  if (v.lane_position < graph_.lane(lane).length - kNearEnd) return false;
  return std::ranges::none_of(traffic_.vehicles(), [&](const VehicleState& other) {
    return other.lane_position > v.lane_position && other.lane == v.lane;
  });
}

/// Of its route, if its lane does not lead there; else kNone.
int WrongLanes::next_edge(const VehicleState& v, int lane) const {
  const std::span<const std::string> route = traffic_.route_edges(v.id);
  if (route.size() < 2 || route.front() != graph_.lane(lane).edge) return LaneGraph::kNone;
  const int next = graph_.find_edge(route[1]);
  const bool leads_there = next == LaneGraph::kNone || !graph_.links_between(lane, next).empty();
  return leads_there ? LaneGraph::kNone : next;
}

std::vector<WrongLanes::Waiting> WrongLanes::waiting() const {
  std::vector<Waiting> all;
  for (const VehicleState& v : traffic_.vehicles()) {
    const int lane = graph_.find_lane(v.lane);
    if (lane == LaneGraph::kNone || graph_.edge_of(lane) == LaneGraph::kNone) continue;
    if (v.speed > kStanding || is_controlled_(v.id) || !stands_at_end(v, lane)) continue;
    const int next = next_edge(v, lane);
    if (next == LaneGraph::kNone) continue;
    all.push_back({.state = &v, .lane = lane, .next = next});
  }
  return all;
}

/// Does each stand where the other could go on, and has as much room there?
bool WrongLanes::suit_each_other(const Waiting& a, const Waiting& b) const {
  return graph_.edge_of(a.lane) == graph_.edge_of(b.lane) && a.state->type == b.state->type &&
         !graph_.links_between(a.lane, b.next).empty() &&
         !graph_.links_between(b.lane, a.next).empty();
}

void WrongLanes::look() {
  const std::vector<Waiting> all = waiting();
  std::map<std::string, Wait> waits;
  for (const Waiting& w : all) {
    const auto before = waits_.find(w.state->id);
    waits.emplace(w.state->id, before == waits_.end() ? Wait{traffic_.time()} : before->second);
  }
  waits_ = std::move(waits);
  for (const Waiting& w : all) {
    const auto wait = waits_.find(w.state->id);
    if (wait == waits_.end() || traffic_.time() - wait->second.since < kGivesUp) continue;
    const auto other = std::ranges::find_if(all, [&](const Waiting& o) {
      return waits_.contains(o.state->id) && suit_each_other(w, o);
    });
    if (other != all.end()) {
      traffic_.swap_lanes(w.state->id, other->state->id);
      waits_.erase(other->state->id);
      waits_.erase(w.state->id);
      ++swaps_;
    } else if (!wait->second.no_path) {
      wait->second.no_path = !traffic_.detour(w.state->id);
      if (wait->second.no_path) continue;
      waits_.erase(wait);
      ++detours_;
    }
  }
}

}  // namespace mvtp
