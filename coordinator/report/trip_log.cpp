#include "coordinator/report/trip_log.hpp"

#include <algorithm>

namespace mvtp {

void TripLog::observe(const Snapshot& now) {
  const double dt = traffic_.step_length();
  for (const std::string& id : now.pending) wanted_.emplace(id, now.time - dt);
  for (std::size_t i = 0; i < now.vehicles.size(); ++i) {
    const Observation& s = now.vehicles[i];
    const auto [found, is_new] = entries_.try_emplace(s.state->id);
    Entry& entry = found->second;
    if (is_new) begin(now, s, entry);
    entry.coordinated = entry.coordinated || s.coordinated;
    if (now.resting[i] != 0) entry.stopped += dt;
    if (!s.state->lane.empty()) {
      entry.trip.arrival_lane = s.state->lane;
      entry.trip.arrival_position = s.state->lane_position;
    }
    entry.last_seen = now.time;
  }
  last_ = now.time;
}

void TripLog::begin(const Snapshot& now, const Observation& observation, Entry& entry) const {
  const VehicleState& v = *observation.state;
  const double depart = now.time - traffic_.step_length();
  const auto wanted = wanted_.find(v.id);
  entry.route = traffic_.route(v.id);
  entry.top_speed = v.top_speed;
  entry.trip = {.id = v.id,
                .type = v.type,
                .depart = depart,
                .depart_delay = wanted == wanted_.end() ? 0.0 : depart - wanted->second,
                .depart_lane = v.lane.empty() ? first_lane(entry.route.front()) : v.lane,
                .depart_position = v.lane_position,
                .depart_speed = v.speed,
                .speed_factor = v.speed_factor};
}

const std::string& TripLog::first_lane(const std::string& edge) const {
  return traffic_.network().edges.at(edge).front();
}

std::vector<Trip> TripLog::trips() const {
  std::vector<Trip> trips;
  for (const auto& [id, entry] : entries_) {
    Trip trip = entry.trip;
    if (entry.last_seen < last_) trip.arrival = entry.last_seen;
    trip.duration = entry.last_seen - *trip.depart;
    trips.push_back(std::move(trip));
  }
  for (const auto& [id, time] : wanted_) {
    if (!entries_.contains(id)) trips.push_back({.id = id, .depart_delay = last_ - time});
  }
  return trips;
}

std::vector<VehicleRecord> TripLog::records(
    std::span<const Trip> trips, const FreeFlow& free_flow, double end,
    const std::function<double(const std::string&)>& max_speed,
    const std::map<std::string, double>& clearances) const {
  const RoadNetwork& network = traffic_.network();
  std::vector<VehicleRecord> records;
  for (const Trip& trip : trips) {
    VehicleRecord v{.id = trip.id,
                    .type = trip.type,
                    .intended_departure = trip.depart.value_or(end) - trip.depart_delay,
                    .departure = trip.depart,
                    .arrival = trip.arrival,
                    .time_loss = trip.time_loss,
                    .waiting_time = trip.waiting_time,
                    .speed_factor = trip.speed_factor,
                    .emissions = trip.emissions};
    if (const auto c = clearances.find(trip.id); c != clearances.end()) v.min_clearance = c->second;
    if (const auto known = entries_.find(trip.id); known != entries_.end()) {
      const Entry& entry = known->second;
      v.coordinated = entry.coordinated;
      v.stopped = entry.stopped;
      v.movement = entry.route.front() + ">" + entry.route.back();
      const double last = network.lanes.at(first_lane(entry.route.back())).length;
      v.free_flow =
          free_flow.duration(entry.route, trip.depart_lane, trip.depart_position,
                             trip.arrival ? trip.arrival_position : last, trip.speed_factor,
                             std::min(max_speed(trip.type), entry.top_speed));
    }
    records.push_back(std::move(v));
  }
  std::ranges::sort(records, {}, &VehicleRecord::id);
  return records;
}

std::map<std::string, double> TripLog::times_at_gate(
    std::span<const Trip> trips, const FreeFlow& free_flow, double end, const ParkingLot& lot,
    const std::function<VehicleType(const std::string&)>& type) const {
  std::map<std::string, double> times;
  for (const Trip& trip : trips) {
    const auto known = entries_.find(trip.id);
    const double intended = trip.depart.value_or(end) - trip.depart_delay;
    if (known == entries_.end()) {
      times[trip.id] = intended;  // it never got onto the road
      continue;
    }
    const std::vector<std::string>& route = known->second.route;
    for (const LotLane& entry : lot.entries) {
      const auto edge = std::ranges::find(route, traffic_.network().lanes.at(entry.lane).edge);
      if (edge == route.end()) continue;
      const Vehicle body = type(trip.type).body;
      times[trip.id] =
          intended + free_flow.duration(std::span(route.begin(), edge + 1), trip.depart_lane,
                                        trip.depart_position, entry.offset + body.length(),
                                        trip.speed_factor,
                                        std::min(body.max_speed, known->second.top_speed));
    }
  }
  return times;
}

}  // namespace mvtp
