#include "traci_bridge/sumo_stops.hpp"

#include <algorithm>
#include <vector>

#include "traci_bridge/sumo_reading.hpp"

namespace mvtp::MVTP_SUMO_NAMESPACE {

std::optional<Stop> SumoStops::next(const std::string& id) const {
  std::vector<libsumo::TraCINextStopData> stops = api::Vehicle::getStops(id, 0);
  std::erase_if(stops, [&](const auto& stop) { return holds_.is_hold(id, stop); });
  if (stops.empty()) stops = routes_.stops_behind(id);
  if (stops.empty()) return std::nullopt;
  const libsumo::TraCINextStopData& next = stops.front();
  return Stop{.lane = next.lane,
              .edge = network_.lanes.contains(next.lane)
                          ? network_.lanes.at(next.lane).edge
                          : next.lane.substr(0, next.lane.rfind('_')),
              .position = next.endPos,
              .duration = std::max(next.duration, 0.0),
              .until = next.until < 0.0 ? -1.0 : next.until,
              .reached = next.arrival >= 0.0};
}

std::optional<ParkingStop> SumoStops::parking(const std::string& id) const {
  if (leaving_.contains(id)) return std::nullopt;
  const std::optional<NextStop> next = next_parking_stop(id);
  if (!next) return std::nullopt;
  ParkingStop stop{.area = next->data.stoppingPlaceID,
                   .duration = std::max(next->data.duration, 0.0),
                   .until = next->data.until < 0.0 ? -1.0 : next->data.until,
                   .parked = is_parked(id)};
  // SUMO counts it down, from the step after the one in which the stop was reached.
  if (stop.parked) {
    stop.duration = next->data.duration + clock_.now - clock_.step_length - next->data.arrival;
  }
  return stop;
}

void SumoStops::drop_parking(const std::string& id) {
  const std::optional<NextStop> stop = next_parking_stop(id);
  if (!stop) return;
  if (is_parked(id)) {
    leaving_.insert(id);
  } else {
    api::Vehicle::replaceStop(id, stop->index, "");
  }
}

void SumoStops::leave_parking_areas() {
  std::erase_if(leaving_, [&](const std::string& id) {
    if (is_parked(id) && !is_lane_free_beside(id)) return false;
    if (is_parked(id)) api::Vehicle::resume(id);
    return true;
  });
}

void SumoStops::forget_if(const std::function<bool(const std::string&)>& has_left) {
  std::erase_if(leaving_, has_left);
}

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
