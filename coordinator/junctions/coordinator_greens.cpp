// Signals: the coordinator's own; and those that run their own programs, who is seen before them,
// and what that closes to whom.

#include <limits>

#include "coordinator/junctions/coordinator.hpp"
#include "planner/road.hpp"

namespace mvtp {

/// See GreenLanes::OverLine.
std::optional<double> Coordinator::over_line(const std::string& id) const {
  const auto found = driven_.find(id);
  if (found == driven_.end()) return std::nullopt;
  const Driven& driven = found->second;
  const std::vector<double>& lines = corridors_[driven.corridor].lines;
  const auto line = std::ranges::upper_bound(lines, driven.road.now.s);
  if (line == lines.end()) return std::nullopt;
  const SpeedProfile* plan = plan_.find(driven.key);
  if (plan == nullptr || !plan->complete) return std::numeric_limits<double>::infinity();
  return double(arrival_step(*plan, *line) - effective_step()) * grid_.dt;
}

/// Lights that are due to change do so, and people are looked at, before anything is decided.
void Coordinator::look_at_signals() {
  if (shows_lights()) {
    heads_->own();
    heads_->advance();
  }
  if (people_ && (shows_lights() || greens_)) {
    people_->begin(step_, [this](const std::string& crossing) {
      const std::vector<Forecast> people = expect_people({crossing});
      return std::ranges::none_of(driven_, [&](const auto& entry) {
        const SpeedProfile* plan = plan_.find(entry.second.key);
        return plan != nullptr && meets_one(people, entry.second.road.path, *plan);
      });
    });
  }
  if (greens_) sense_drivers();
}

/// Human drivers on their way to lines with a light.
void Coordinator::sense_drivers() {
  greens_->begin(effective_step());
  for (const VehicleState& v : traffic_.vehicles()) {
    if (options_.share.contains(v.id, v.type)) continue;
    const int lane = graph_.find_lane(v.lane);
    if (lane == LaneGraph::kNone) continue;
    const std::vector<int> route = route_of(v);
    const CourseQuery query = query_for(v, route);
    if (!greens_->governs(query)) continue;
    greens_->sense_inside(v, query, type_of(v.type));
    const std::optional<double> to_line = finder_.distance_to_line(query);
    if (!to_line) continue;
    const auto inside = std::size_t(graph_.edge_of(lane) == LaneGraph::kNone);
    for (std::size_t i = inside; i < route.size(); ++i) {
      if (!finder_.is_coordinated(graph_.junction_behind(route[i]))) continue;
      const bool is_there = i == 0;
      greens_->sense(v, route[i], is_there ? lane : LaneGraph::kNone, *to_line, type_of(v.type));
      break;
    }
  }
}

/// Tells everybody under control, or about to be, which ground is not theirs.
void Coordinator::close_ground(std::map<std::string, Driven>& arrivals) {
  const auto close = [&](const std::string& id, Driven& driven) {
    greens_->close(driven.road, driven.corridor, type_of(find_state(id)->type));
  };
  for (auto& [id, driven] : driven_) close(id, driven);
  for (auto& [id, arrival] : arrivals) close(id, arrival);
}

}  // namespace mvtp
