#include "traci_bridge/sumo_lanes.hpp"

#include <algorithm>

#include "traci_bridge/tail_lanes.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {
namespace {

// How far the tail is behind the begin of the lane where SUMO's idea of it cannot get stale within
// a step: for any speed up to 40 m/s.
constexpr double kTailRoom = 2.0;   // [m]
constexpr double kTailTime = 40.0;  // [m/s]

}  // namespace

SumoLanes::SumoLanes(const RoadNetwork& network, SumoLog& log) : network_(network), log_(log) {
  for (const auto& [id, junction] : network_.junctions) {
    for (const Connection& c : junction.connections) {
      leaving_.emplace(c.from_lane, &c);
      const Lane* before = &network_.lanes.at(c.from_lane);
      for (const std::string& via : c.via) {
        inside_[via] = &c;
        note_before(via, *before);
        before = &network_.lanes.at(via);
      }
      note_before(c.to_lane, *before);
    }
  }
}

void SumoLanes::note_before(const std::string& lane, const Lane& before) {
  const Lane*& shortest = shortest_before_.emplace(lane, &before).first->second;
  if (before.length < shortest->length) shortest = &before;
}

const Lane* SumoLanes::settle(const std::string& id, std::span<const std::string> rest,
                              double speed, double step_length) {
  const auto found = network_.lanes.find(api::Vehicle::getLaneID(id));
  if (found == network_.lanes.end()) return nullptr;
  const Lane& lane = found->second;
  const double position = std::min(api::Vehicle::getLanePosition(id), lane.length);
  if (!has_stale_tail(id, lane, position, step_length) && !is_misplaced(lane, rest)) return &lane;
  const std::optional<Place> other = place_beside(lane, position, rest);
  if (!other) return &lane;
  try {
    api::Vehicle::moveTo(id, other->lane, other->position);
    const double length = api::Vehicle::getLength(id);
    const double to = where_tail_is_found(position, length, speed * step_length, lane.length,
                                          lengths_before(lane, length));
    api::Vehicle::moveTo(id, lane.id, to);
  } catch (const libsumo::TraCIException&) {
    static_cast<void>(log_.take_errors());  // not on the route: it is placed all the same
  }
  return &lane;
}

/// May its tail have left a lane that lies between two others on which SUMO believes it to be?
bool SumoLanes::has_stale_tail(const std::string& id, const Lane& lane, double position,
                               double step_length) const {
  const auto before = shortest_before_.find(lane.id);
  if (before == shortest_before_.end()) return false;
  const double length = api::Vehicle::getLength(id);
  return before->second->length < length &&
         position - length < std::max(kTailRoom, kTailTime * step_length);
}

/// Of the shortest lanes that lead here, the next one first [m].
std::vector<double> SumoLanes::lengths_before(const Lane& lane, double reach) const {
  std::vector<double> lengths;
  auto before = shortest_before_.find(lane.id);
  for (double covered = 0.0; covered <= reach && before != shortest_before_.end();) {
    lengths.push_back(before->second->length);
    covered += lengths.back();
    before = shortest_before_.find(before->second->id);
  }
  return lengths;
}

/// Does SUMO take another edge for the one that leads to this internal lane?
bool SumoLanes::is_misplaced(const Lane& lane, std::span<const std::string> rest) const {
  const auto inside = inside_.find(lane.id);
  if (inside == inside_.end()) return false;
  return rest.front() != network_.lanes.at(inside->second->from_lane).edge;
}

/// A place on another lane of the vehicle's route, near to where it is.
std::optional<SumoLanes::Place> SumoLanes::place_beside(const Lane& lane, double position,
                                                        std::span<const std::string> rest) const {
  if (const auto inside = inside_.find(lane.id); inside != inside_.end()) {
    const Lane& from = network_.lanes.at(inside->second->from_lane);
    return Place{from.id, from.length};
  }
  for (const std::string& sibling : network_.edges.at(lane.edge)) {
    if (sibling == lane.id) continue;
    return Place{sibling, std::min(position, network_.lanes.at(sibling).length)};
  }
  const auto [first, last] = leaving_.equal_range(lane.id);
  for (auto connection = first; connection != last; ++connection) {
    const Connection& c = *connection->second;
    const bool follows = rest.size() > 1 && network_.lanes.at(c.to_lane).edge == rest[1];
    if (follows && !c.via.empty()) return Place{c.via.front(), 0.0};
  }
  return std::nullopt;
}

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
