// How the drivers of FakeTraffic drive.
#include "tests/coordinator/fake_drivers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coordinator/signals/signal_heads.hpp"
#include "tests/coordinator/fake_traffic.hpp"

namespace mvtp {
namespace {

constexpr int kNone = LaneGraph::kNone;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEmergency = 9.0;    ///< [m/s^2] at most, when there is no other way
constexpr double kClear = 60.0;       ///< [m] before a junction in which nobody may come
constexpr double kLateChange = 30.0;  ///< [m] before the end of a lane drivers change it
constexpr double kLook = 30.0;        ///< [m] ahead, beside the braking distance

}  // namespace

double safe_speed(double room, double leader, double decel, double reaction) {
  const double b = decel * reaction;
  return -b + std::sqrt(b * b + leader * leader + 2.0 * decel * std::max(0.0, room));
}

double stopping(double v, double decel) { return v * v / (2.0 * decel); }

/// The connection by which a vehicle goes on from a lane of an edge of its route: onto a lane that
/// leads further, if there is one.
int FakeTraffic::link_from(const Car& car, int lane, std::size_t edge) const {
  int best = kNone;
  for (const int k : graph_.links_from(lane)) {
    const LaneGraph::Link& link = graph_.link(k);
    if (edge + 1 >= car.route.size() || graph_.edge_of(link.to) != car.route[edge + 1]) continue;
    const bool is_wanted =
        edge > 0 || car.trip.onto.empty() || graph_.lane(link.to).id == car.trip.onto;
    const bool leads_on =
        is_wanted && (edge + 2 >= car.route.size() || link_from(car, link.to, edge + 1) != kNone);
    if (best == kNone || leads_on) best = k;
    if (leads_on) break;
  }
  return best;
}

std::vector<FakeTraffic::Ahead> FakeTraffic::lanes_ahead(const Car& car, double reach) const {
  std::vector<Ahead> ahead = {{car.lane, kNone, -car.position}};
  std::size_t edge = car.edge;
  int lane = car.lane;
  double distance = graph_.lane(lane).length - car.position;
  const auto append = [&](int next, int link) {
    ahead.push_back({next, link, distance});
    distance += graph_.lane(next).length;
    lane = next;
  };
  if (!is_normal(lane)) {
    for (const int k : graph_.links_over(lane)) {
      const LaneGraph::Link& link = graph_.link(k);
      if (graph_.edge_of(link.to) != car.route[edge + 1]) continue;
      for (auto via = std::ranges::find(link.via, lane) + 1; via != link.via.end(); ++via) {
        append(*via, kNone);
      }
      append(link.to, kNone);
      ++edge;
      break;
    }
  }
  while (distance < reach) {
    const int k = link_from(car, lane, edge);
    if (k == kNone) break;
    int by = k;
    for (const int via : graph_.link(k).via) append(via, std::exchange(by, kNone));
    append(graph_.link(k).to, std::exchange(by, kNone));
    ++edge;
  }
  return ahead;
}

void FakeTraffic::plan_speed(Car& car) {
  const Vehicle& body = car.type.body;
  const double reaction = std::max(car.type.tau, step_length_);
  const double limit = std::min(graph_.lane(car.lane).speed_limit, body.max_speed);
  double next = std::min(limit, car.speed + body.max_accel * step_length_);
  const auto heed = [&](double room, double speed) {
    next = std::min(next, safe_speed(room, speed, body.max_decel, reaction));
  };
  change_lane(car);
  const double reach = stopping(car.speed, body.max_decel) + car.speed * reaction + kLook;
  const std::vector<Ahead> ahead = lanes_ahead(car, reach);
  for (const Ahead& on : ahead) {
    if (on.link != kNone && !may_enter(car, on.link, on.distance)) {
      heed(on.distance - kLineGap, 0.0);
      break;
    }
    double speed = 0.0;
    const double room = room_to_leader(car, on, speed);
    if (room < kInfinity) heed(room - car.type.min_gap, speed);
    const double slower = graph_.lane(on.lane).speed_limit;
    const double room_to_slow = std::max(0.0, on.distance - car.speed * step_length_);
    next = std::min(next, std::sqrt(slower * slower + 2.0 * body.max_decel * room_to_slow));
    if (car.trip.stop && graph_.find_lane(car.trip.stop->lane) == on.lane) {
      heed(on.distance + car.trip.stop->position, 0.0);
    }
  }
  const double lane_end = graph_.lane(car.lane).length - car.position;
  const bool leads_on = car.edge + 1 == car.route.size() || !is_normal(car.lane) ||
                        link_from(car, car.lane, car.edge) != kNone;
  if (car.held_on == car.lane || !leads_on) heed(lane_end - kLineGap, 0.0);
  double speed = 0.0;
  const double room = room_to_bodies(car, reach, speed);
  if (room < kInfinity) heed(room - 1.0, speed);
  if (frozen_.contains(car.trip.id)) next = 0.0;
  const double least = frozen_.contains(car.trip.id) ? body.max_decel : kEmergency;
  car.next_speed = std::max({0.0, next, car.speed - least * step_length_});
}

double FakeTraffic::room_to_leader(const Car& car, const Ahead& on, double& speed) const {
  const auto there = occupants_.find(on.lane);
  double room = kInfinity;
  if (there == occupants_.end()) return room;
  for (const Span& span : there->second) {
    // Whose front is behind is no leader; on a route that passes a lane twice it may be itself.
    if (span.car == &car || (on.distance <= 0.0 && span.front <= car.position)) continue;
    if (on.distance + span.rear >= room) continue;
    room = on.distance + span.rear;
    speed = span.car->speed;
  }
  return room;
}

/// The room to the first body across the own path inside the junctions ahead. Whoever was told to
/// pass looks only at those that come from its own lane.
double FakeTraffic::room_to_bodies(const Car& car, double reach, double& speed) const {
  constexpr double kStep = 1.0;  // [m]
  const std::vector<Ahead> ahead = lanes_ahead(car, reach);
  double room = kInfinity;
  for (const Ahead& on : ahead) {
    if (is_normal(on.lane) || on.distance > std::min(reach, room)) continue;
    const double length = graph_.lane(on.lane).length;
    for (const auto& [id, other] : cars_) {
      if (&other == &car) continue;
      const Point from = point_on(on.lane, 0.0);
      if (std::hypot(other.pose.x - from.x, other.pose.y - from.y) > 40.0) continue;
      const auto known = std::ranges::find(other.trail, ahead.front().lane);
      const bool same_origin = other.lane == ahead.front().lane || known != other.trail.end();
      if ((car.passes || car.waiting.contains(id)) && !same_origin) continue;
      for (double s = std::max(0.0, -on.distance + 0.5); s < length; s += kStep) {
        if (on.distance + s >= room) break;
        const Point p = point_on(on.lane, s);
        const Pose local = relative(other.pose, {p.x, p.y, 0.0});
        const double half = 0.5 * (other.type.body.width + car.type.body.width) + 0.2;
        const bool inside = local.x < other.type.body.front + 0.5 &&
                            local.x > -other.type.body.rear - 0.5 && std::abs(local.y) < half;
        if (!inside) continue;
        room = on.distance + s;
        const double along = std::cos(other.pose.theta - car.pose.theta);
        speed = other.speed * std::max(0.0, same_origin ? along : 0.0);
        break;
      }
    }
  }
  return room;
}

bool FakeTraffic::may_enter(Car& car, int k, double distance) {
  const LaneGraph::Link& link = graph_.link(k);
  const double braking = stopping(car.speed, car.type.body.max_decel);
  if (car.held_on == link.from) return distance + 0.1 < kLineGap;
  if (const auto light = lights_.find({link.signal, link.signal_index}); light != lights_.end()) {
    if (light->second == kYieldingGreen && must_yield(car, k)) return distance < braking;
    const bool green = light->second == Light::kGreen || light->second == kYieldingGreen;
    return green || distance < braking;
  }
  if (car.passes || !graph_.junction(link.junction).has_conflicts) return true;
  if (car.granted == link.junction) return true;
  if (distance < braking) return true;  // too late
  if (distance > braking + car.speed * step_length_ + 10.0 || !is_clear(car, k)) return false;
  car.granted = link.junction;
  return true;
}

/// Does somebody with green come from the other side, or stand across its path? Drivers wait for
/// those at their line.
bool FakeTraffic::must_yield(const Car& car, int k) const {
  const LaneGraph::Link& link = graph_.link(k);
  return std::ranges::any_of(cars_, [&](const auto& entry) {
    const Car& other = entry.second;
    if (&other == &car || car.waiting.contains(entry.first)) return false;
    const bool inside = !is_normal(other.lane);
    const int lane = inside ? (other.trail.empty() ? kNone : other.trail.back()) : other.lane;
    if (lane == kNone || lane == link.from) return false;
    const int theirs =
        inside ? graph_.links_over(other.lane).front() : link_from(other, other.lane, other.edge);
    if (theirs == kNone || graph_.link(theirs).junction != link.junction) return false;
    const auto light = lights_.find({graph_.link(theirs).signal, graph_.link(theirs).signal_index});
    const bool is_first = std::ranges::none_of(cars_, [&](const auto& ahead) {
      return ahead.second.lane == other.lane && ahead.second.position > other.position;
    });
    const bool comes = is_first && light != lights_.end() && light->second == Light::kGreen &&
                       graph_.lane(other.lane).length - other.position < kClear;
    return inside || comes;
  });
}

/// Is nobody from elsewhere on the junction or near it, and room behind it?
bool FakeTraffic::is_clear(const Car& car, int k) const {
  const LaneGraph::Link& link = graph_.link(k);
  for (const auto& [id, other] : cars_) {
    if (&other == &car) continue;
    if (other.granted == link.junction && other.lane != link.from) return false;
    const bool near = is_normal(other.lane) && other.lane != link.from &&
                      graph_.junction_behind(graph_.edge_of(other.lane)) == link.junction &&
                      graph_.lane(other.lane).length - other.position < kClear;
    if (near && (other.placed || other.passes)) return false;
  }
  for (int other = 0; other < graph_.links(); ++other) {
    if (graph_.link(other).junction != link.junction || graph_.link(other).from == link.from) {
      continue;
    }
    for (const int via : graph_.link(other).via) {
      const auto there = occupants_.find(via);
      if (there != occupants_.end() && !there->second.empty()) return false;
    }
  }
  const auto behind = occupants_.find(link.to);
  if (behind == occupants_.end()) return true;
  return std::ranges::all_of(behind->second, [&](const Span& span) {
    return span.car == &car || span.car->speed > 5.0 ||
           span.rear > car.type.body.length() + car.type.min_gap;
  });
}

/// Drivers change to the lane that leads on within one step, as late as they can.
void FakeTraffic::change_lane(Car& car) {
  if (!is_normal(car.lane) || car.position < car.type.body.length() + 1.0) return;
  if (link_from(car, car.lane, car.edge) != kNone || car.edge + 1 == car.route.size()) return;
  if (graph_.lane(car.lane).length - car.position > kLateChange) return;
  const std::span<const int> lanes = graph_.lanes_of(graph_.edge_of(car.lane));
  const auto here = std::ranges::find(lanes, car.lane) - lanes.begin();
  for (const auto beside : {here + 1, here - 1}) {
    if (beside < 0 || beside >= std::ssize(lanes)) continue;
    const int lane = lanes[std::size_t(beside)];
    if (link_from(car, lane, car.edge) == kNone) continue;
    const bool room = std::ranges::all_of(occupants_[lane], [&](const Span& span) {
      return span.rear > car.position + 3.0 + car.speed ||
             span.front < car.position - car.type.body.length() - 3.0 - 2.0 * span.car->speed;
    });
    if (!room) continue;
    car.lane = lane;
    car.trail.clear();
    car.held_on = car.held_on == kNone ? kNone : lane;
    find_occupants();
    return;
  }
}

void FakeTraffic::enter(Car& car, int lane) {
  car.trail.push_back(car.lane);
  if (car.trail.size() > 12) car.trail.erase(car.trail.begin());
  if (is_normal(lane)) ++car.edge;
  if (is_normal(lane)) car.granted = kNone;
  car.lane = lane;
}

void FakeTraffic::drive(Car& car) {
  car.speed = car.next_speed;
  double driven = car.speed * step_length_;
  const std::vector<Ahead> ahead = lanes_ahead(car, driven + 1.0);
  std::size_t next = 1;
  while (car.position + driven >= graph_.lane(car.lane).length && next < ahead.size()) {
    driven -= graph_.lane(car.lane).length - car.position;
    car.position = 0.0;
    enter(car, ahead[next++].lane);
  }
  car.position = std::min(car.position + driven, graph_.lane(car.lane).length);
  set_pose(car);
  if (!car.trip.stop) return;
  const bool here = graph_.find_lane(car.trip.stop->lane) == car.lane && car.speed < 0.1 &&
                    std::abs(car.position - car.trip.stop->position) < 1.5;
  if (here) car.stood += step_length_;
  if (car.stood >= car.trip.stop->duration && here) car.trip.stop.reset();
}

}  // namespace mvtp
