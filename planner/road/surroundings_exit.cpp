// Headways on the exit lane: who is ahead of whom there, and the room that drivers want.

#include <algorithm>
#include <optional>

#include "planner/road/surroundings.hpp"

namespace mvtp {

std::optional<double> Surroundings::place_on_exit(const Other& other,
                                                  const InertialState& state) const {
  if (other.vehicle->exit_lane != vehicle_.exit_lane || state.s >= SpeedProfile::kDeparted) {
    return std::nullopt;
  }
  return state.s - other.vehicle->s_exit_lane;
}

std::optional<double> Surroundings::place_on_next(const Other& other,
                                                  const InertialState& state) const {
  for (const EntryLane& entry : other.vehicle->entry_lanes) {
    if (entry.lane == vehicle_.exit_lane && entry.is_there(state.s)) return state.s - entry.s_lane;
  }
  return std::nullopt;
}

bool Surroundings::keeps_headway(std::int64_t k, const InertialState& state) const {
  const double d = state.s - vehicle_.s_exit_lane;
  if (d <= 0.0 || vehicle_.exit_lane < 0) return true;
  const OnExit self{.place = d, .v = state.v, .vehicle = &vehicle_, .body = &body_};
  for (const std::size_t i : on_exit_) {
    const Other& other = others_[i];
    const InertialState o = other.profile->at(k);
    OnExit ahead{.place = d, .v = o.v, .vehicle = other.vehicle, .body = other.body};
    if (const std::optional<double> place = place_on_next(other, o); place && *place > d) {
      ahead.place = *place;
      if (!is_behind_well(self, ahead)) return false;
    }
    ahead.place = place_on_exit(other, o).value_or(0.0);
    if (ahead.place <= 0.0) continue;
    if (d <= ahead.place ? !is_behind_well(self, ahead) : !is_behind_well(ahead, self))
      return false;
  }
  return true;
}

bool Surroundings::leaves_room(std::int64_t k, const InertialState& state) const {
  const double d = state.s - vehicle_.s_exit_lane;
  for (const Other& other : others_) {
    const InertialState o = (other.latest != nullptr ? other.latest : other.profile)->at(k);
    for (const auto& place : {place_on_exit(other, o), place_on_next(other, o)}) {
      if (!place || *place <= d) continue;
      const double wanted =
          drivers_gap(vehicle_, state.v, body_.max_decel, o.v, other.body->max_decel);
      if (*place - d - other.body->length() < wanted) return false;
    }
  }
  return true;
}

bool Surroundings::is_behind_well(const OnExit& behind, const OnExit& ahead) const {
  const RoadVehicle& v = *behind.vehicle;
  const double length =
      std::clamp(v.s_handback - v.s_exit_lane, options_.least_ramp, options_.headway_ramp);
  const double ramp = std::clamp(behind.place / length, 0.0, 1.0);
  const double braking = stopping_distance(behind.v, behind.body->max_decel) -
                         stopping_distance(ahead.v, ahead.body->max_decel);
  const double wanted =
      ramp * (options_.exit_gap + options_.exit_headway * behind.v + std::max(0.0, braking));
  return ahead.place - behind.place - ahead.body->length() >= wanted;
}

}  // namespace mvtp
