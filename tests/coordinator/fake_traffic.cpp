#include "tests/coordinator/fake_traffic.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "coordinator/signal_heads.hpp"

namespace mvtp {
namespace {

constexpr int kNone = LaneGraph::kNone;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEmergency = 9.0;    ///< [m/s^2] at most, when there is no other way
constexpr double kLineGap = 1.0;      ///< [m] before a line where drivers stop
constexpr double kClear = 60.0;       ///< [m] before a junction in which nobody may come
constexpr double kLateChange = 30.0;  ///< [m] before the end of a lane drivers change it
constexpr double kLook = 30.0;        ///< [m] ahead, beside the braking distance

Point lerp(const Point& a, const Point& b, double f) {
  return {a.x + f * (b.x - a.x), a.y + f * (b.y - a.y)};
}

double distance(const Point& a, const Point& b) { return std::hypot(b.x - a.x, b.y - a.y); }

double length_of(const std::vector<Point>& line) {
  double length = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) length += distance(line[i - 1], line[i]);
  return length;
}

/// The place on a line nearest to a point: how far along it [m], and how far off.
struct Foot {
  double along = 0.0;
  double off = kInfinity;
};
Foot foot_on(const std::vector<Point>& line, const Point& p) {
  Foot best;
  double before = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Point& a = line[i - 1];
    const Point& b = line[i];
    const double length = distance(a, b);
    const double along =
        std::clamp(((p.x - a.x) * (b.x - a.x) + (p.y - a.y) * (b.y - a.y)) / length, 0.0, length);
    const double off = distance(lerp(a, b, along / length), p);
    if (off < best.off - 1e-9) best = {before + along, off};
    before += length;
  }
  return best;
}

/// The speed from which one can stop behind a leader that brakes as hard [Krauss 1998].
double safe_speed(double room, double leader, double decel, double reaction) {
  const double b = decel * reaction;
  return -b + std::sqrt(b * b + leader * leader + 2.0 * decel * std::max(0.0, room));
}

double stopping(double v, double decel) { return v * v / (2.0 * decel); }

}  // namespace

VehicleType fake_type(const std::string& id) {
  VehicleType type{.id = id};
  type.body = {.front = 3.6,
               .rear = 0.9,
               .width = 1.8,
               .wheelbase = 2.7,
               .min_turning_radius = 3.86,
               .max_speed = 55.0,
               .max_accel = 2.6,
               .max_decel = 4.5};
  if (id == "bus" || id == "truck") {
    const bool bus = id == "bus";
    type.body.front = bus ? 8.64 : 13.0;
    type.body.rear = bus ? 3.36 : 5.0;
    type.body.width = 2.5;
    type.body.wheelbase = bus ? 6.0 : 8.0;
    type.body.min_turning_radius = bus ? 6.0 : 8.0;
    type.body.max_accel = bus ? 1.2 : 1.0;
    type.body.max_decel = 4.0;
    type.vehicle_class = id;
  } else if (id == "bike") {
    type.body.front = 1.4;
    type.body.rear = 0.2;
    type.body.width = 0.65;
    type.body.wheelbase = 1.1;
    type.body.max_speed = 5.5;
    type.body.max_accel = 1.2;
    type.body.max_decel = 3.0;
    type.vehicle_class = "bicycle";
  }
  return type;
}

std::vector<std::string> shortest_route(const RoadNetwork& network, const std::string& from,
                                        const std::string& to) {
  const auto edge_of = [&](const std::string& lane) { return network.lanes.at(lane).edge; };
  std::map<std::string, std::pair<double, std::string>> best = {{from, {0.0, ""}}};
  std::set<std::pair<double, std::string>> open = {{0.0, from}};
  while (!open.empty()) {
    const auto [cost, edge] = *open.begin();
    open.erase(open.begin());
    if (edge == to) break;
    for (const auto& [id, junction] : network.junctions) {
      for (const Connection& c : junction.connections) {
        if (edge_of(c.from_lane) != edge) continue;
        const std::string next = edge_of(c.to_lane);
        const double sum = cost + network.lanes.at(c.to_lane).length + 10.0;
        if (best.contains(next) && best.at(next).first <= sum) continue;
        best[next] = {sum, edge};
        open.emplace(sum, next);
      }
    }
  }
  std::vector<std::string> route;
  if (!best.contains(to)) return route;
  for (std::string edge = to; !edge.empty(); edge = best.at(edge).second) {
    route.insert(route.begin(), edge);
  }
  return route;
}

FakeTraffic::FakeTraffic(RoadNetwork network, std::vector<FakeTrip> trips, double step_length,
                         std::map<std::string, std::vector<SignalPhase>> programs)
    : network_(std::move(network)),
      graph_(network_),
      step_length_(step_length),
      programs_(std::move(programs)) {
  for (FakeTrip& trip : trips) add(std::move(trip));
}

void FakeTraffic::add(FakeTrip trip) {
  if (trip.edges.empty()) trip.edges = shortest_route(network_, trip.from, trip.to);
  const auto later = std::ranges::upper_bound(waiting_, trip.depart, {}, &FakeTrip::depart);
  waiting_.insert(later, std::move(trip));
}

std::vector<std::string> FakeTraffic::pending() const {
  std::vector<std::string> ids;
  for (const FakeTrip& trip : waiting_) {
    if (trip.depart <= time_) ids.push_back(trip.id);
  }
  std::ranges::sort(ids);
  return ids;
}

std::vector<std::string> FakeTraffic::route(const std::string& id) const {
  const auto car = cars_.find(id);
  if (car == cars_.end()) return std::ranges::find(waiting_, id, &FakeTrip::id)->edges;
  std::vector<std::string> edges;
  for (std::size_t i = car->second.edge; i < car->second.route.size(); ++i) {
    edges.push_back(graph_.edge_id(car->second.route[i]));
  }
  return edges;
}

bool FakeTraffic::is_taken_over(const std::string& id) const {
  const auto car = cars_.find(id);
  return car != cars_.end() && car->second.placed;
}

void FakeTraffic::take_over(const std::string& id) {
  cars_.at(id).placed = true;
  cars_.at(id).trip.aside = 0.0;
}

void FakeTraffic::place(const std::string& id, const Pose& pose, double speed) {
  Car& car = cars_.at(id);
  if (!car.placed) return;
  car.pose = pose;
  car.speed = speed;
}

/// As SUMO's stops: none inside a junction, and none that is too near to brake.
void FakeTraffic::hold(const std::string& id, bool stop) {
  const auto found = cars_.find(id);
  if (found == cars_.end()) return;
  Car& car = found->second;
  car.held_on = kNone;
  if (!stop || !is_normal(car.lane)) return;
  const double room = graph_.lane(car.lane).length - kLineGap - car.position;
  if (stopping(car.speed, car.type.body.max_decel) > room + 0.1) return;
  car.held_on = car.lane;
  car.granted = kNone;
}

void FakeTraffic::let_through(const std::string& id, bool pass) {
  const auto found = cars_.find(id);
  if (found == cars_.end()) return;
  found->second.passes = pass;
  if (pass) ++passages_[id];
}

void FakeTraffic::rely_on_signal(const std::string& id, const std::vector<std::string>& waiting) {
  const auto found = cars_.find(id);
  if (found != cars_.end()) found->second.waiting = {waiting.begin(), waiting.end()};
}

bool FakeTraffic::is_held(const std::string& id) const {
  const auto car = cars_.find(id);
  return car != cars_.end() && car->second.held_on != kNone;
}

std::optional<Stop> FakeTraffic::next_stop(const std::string& id) const {
  const auto found = cars_.find(id);
  if (found == cars_.end() || !found->second.trip.stop) return std::nullopt;
  const FakeStop& stop = *found->second.trip.stop;
  const double left = std::max(0.0, stop.duration - found->second.stood);
  return Stop{.lane = stop.lane,
              .edge = network_.lanes.at(stop.lane).edge,
              .position = stop.position,
              .duration = left,
              .reached = found->second.stood > 0.0};
}

void FakeTraffic::remove(const std::string& id) {
  cars_.erase(id);
  refresh();
}

void FakeTraffic::insert_now() {
  insert_departures();
  refresh();
}

void FakeTraffic::step() {
  time_ += step_length_;
  walkers_.step(time_, step_length_, [&](int c) {
    const PedestrianCrossing& crossing = *graph_.crossing(c).crossing;
    if (crossing.signal.empty()) return true;
    const auto light = lights_.find({crossing.signal, crossing.lights.front()});
    return light != lights_.end() && light->second == Light::kGreen;
  });
  insert_departures();
  find_occupants();
  for (auto& [id, car] : cars_) {
    if (!car.placed) plan_speed(car);
  }
  for (auto& [id, car] : cars_) {
    if (car.placed) {
      const auto before = std::ranges::lower_bound(states_, id, {}, &VehicleState::id);
      locate(car, before != states_.end() && before->id == id ? before->pose : car.pose);
    } else {
      drive(car);
    }
  }
  std::erase_if(cars_, [&](const auto& entry) {
    const Car& car = entry.second;
    const bool there = car.edge + 1 == car.route.size() && is_normal(car.lane) &&
                       car.position >= graph_.lane(car.lane).length - 1e-6;
    arrived_ += there ? 1 : 0;
    return there;
  });
  refresh();
}

FakeTraffic::Car FakeTraffic::make_car(const FakeTrip& trip) const {
  Car car{.trip = trip, .type = fake_type(trip.type)};
  for (const std::string& edge : trip.edges) car.route.push_back(graph_.find_edge(edge));
  car.lane = graph_.lanes_of(car.route.front())[std::size_t(trip.lane)];
  const Lane& lane = graph_.lane(car.lane);
  car.position = std::min(car.type.body.length() + 0.1, lane.length);
  car.speed = std::min(
      {lane.speed_limit, car.type.body.max_speed,
       safe_speed(lane.length - car.position - kLineGap, 0.0, car.type.body.max_decel, 1.0)});
  if (trip.at) std::tie(car.position, car.speed) = *trip.at;
  return car;
}

/// Those that are due enter one after the other, on each lane the first first.
void FakeTraffic::insert_departures() {
  std::set<int> full;
  for (auto trip = waiting_.begin(); trip != waiting_.end() && trip->depart <= time_;) {
    find_occupants();
    Car car = make_car(*trip);
    if (full.contains(car.lane) || !has_room(car)) {
      full.insert(car.lane);
      ++trip;
      continue;
    }
    set_pose(car);
    cars_.insert_or_assign(trip->id, std::move(car));
    trip = waiting_.erase(trip);
  }
}

bool FakeTraffic::has_room(const Car& car) const {
  const auto there = occupants_.find(car.lane);
  if (car.trip.at || there == occupants_.end()) return true;
  return std::ranges::all_of(there->second, [&](const Span& span) {
    const double room = span.rear - car.position - car.type.min_gap;
    return room > 1.0 + car.speed * 1.5 &&
           car.speed <= safe_speed(room, span.car->speed, car.type.body.max_decel, 1.0);
  });
}

void FakeTraffic::find_occupants() {
  occupants_.clear();
  for (const auto& [id, car] : cars_) {
    double left = car.type.body.length();
    double front = car.position;
    int lane = car.lane;
    for (auto behind = car.trail.rbegin();; ++behind) {
      occupants_[lane].push_back({&car, front - left, front});
      left -= front;
      if (left <= 0.0 || behind == car.trail.rend()) break;
      lane = *behind;
      front = graph_.lane(lane).length;
    }
  }
}

/// The connection by which a vehicle goes on from a lane of an edge of its route: onto a lane that
/// leads further, if there is one.
int FakeTraffic::link_from(const Car& car, int lane, std::size_t edge) const {
  int best = kNone;
  for (const int k : graph_.links_from(lane)) {
    const LaneGraph::Link& link = graph_.link(k);
    if (edge + 1 >= car.route.size() || graph_.edge_of(link.to) != car.route[edge + 1]) continue;
    const bool leads_on =
        edge + 2 >= car.route.size() || link_from(car, link.to, edge + 1) != kNone;
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

/// Where on its route a vehicle is that was placed: where its front bumper is nearest to a lane.
void FakeTraffic::locate(Car& car, const Pose& before) {
  const Pose front = compose(car.pose, {car.type.body.front, 0.0, 0.0});
  const Pose was = compose(before, {car.type.body.front, 0.0, 0.0});
  const double reach = 1.2 * std::hypot(front.x - was.x, front.y - was.y) + 1.0;
  std::vector<int> best_trail;
  double best_position = car.position;
  double least = kInfinity;
  const auto look = [&](int lane, const std::vector<int>& trail, double from, double to) {
    const Lane& l = graph_.lane(lane);
    const double scale = l.length / length_of(l.shape);
    const Foot foot = foot_on(l.shape, {front.x, front.y});
    const double position = foot.along * scale;
    if (position < from || position > to || foot.off >= least - 1e-9) return;
    least = foot.off;
    best_position = position;
    best_trail = trail;
    best_trail.push_back(lane);
  };
  const auto search = [&](const auto& self, int lane, std::size_t edge, double begin,
                          std::vector<int> trail) -> void {
    if (begin > reach) return;
    const double length = graph_.lane(lane).length;
    look(lane, trail, begin < 0.0 ? -begin - 1.0 : 0.0, std::min(length, reach - begin));
    trail.push_back(lane);
    const double end = begin + length;
    if (is_normal(lane)) {
      for (const int k : graph_.links_from(lane)) {
        const LaneGraph::Link& link = graph_.link(k);
        if (edge + 1 >= car.route.size() || graph_.edge_of(link.to) != car.route[edge + 1])
          continue;
        self(self, link.via.empty() ? link.to : link.via.front(),
             link.via.empty() ? edge + 1 : edge, end, trail);
      }
      return;
    }
    for (const int k : graph_.links_over(lane)) {
      const LaneGraph::Link& link = graph_.link(k);
      if (graph_.edge_of(link.from) != car.route[edge]) continue;
      if (edge + 1 >= car.route.size() || graph_.edge_of(link.to) != car.route[edge + 1]) continue;
      const auto next = std::ranges::find(link.via, lane) + 1;
      self(self, next == link.via.end() ? link.to : *next, next == link.via.end() ? edge + 1 : edge,
           end, trail);
    }
  };
  search(search, car.lane, car.edge, -car.position, {});
  if (is_normal(car.lane)) {
    for (const int beside : graph_.lanes_of(graph_.edge_of(car.lane))) {
      if (beside != car.lane) search(search, beside, car.edge, -car.position, {});
    }
  }
  if (best_trail.empty()) return;
  car.lane = best_trail.front();
  for (std::size_t i = 1; i < best_trail.size(); ++i) enter(car, best_trail[i]);
  car.position = best_position;
}

void FakeTraffic::set_pose(Car& car) const {
  const Point front = point_on(car.lane, car.position);
  const Point rear = point_behind(car, car.type.body.length());
  const double theta = std::atan2(front.y - rear.y, front.x - rear.x);
  car.pose = compose({front.x, front.y, theta}, {-car.type.body.front, car.trip.aside, 0.0});
}

/// The point of its lanes that is so far behind its front bumper along them.
Point FakeTraffic::point_behind(const Car& car, double distance) const {
  int lane = car.lane;
  double position = car.position - distance;
  for (auto behind = car.trail.rbegin(); position < 0.0 && behind != car.trail.rend(); ++behind) {
    lane = *behind;
    position += graph_.lane(lane).length;
  }
  return point_on(lane, position);
}

/// Straight on beyond the ends of the lane.
Point FakeTraffic::point_on(int lane, double position) const {
  const std::vector<Point>& line = graph_.lane(lane).shape;
  double s = position * length_of(line) / graph_.lane(lane).length;
  for (std::size_t i = 1;; ++i) {
    const double length = distance(line[i - 1], line[i]);
    if (s <= length || i + 1 == line.size()) return lerp(line[i - 1], line[i], s / length);
    s -= length;
  }
}

void FakeTraffic::refresh() {
  states_.clear();
  for (const auto& [id, car] : cars_) {
    states_.push_back({.id = id,
                       .type = car.trip.type,
                       .pose = car.pose,
                       .speed = car.speed,
                       .lane = graph_.lane(car.lane).id,
                       .lane_position = car.position,
                       .halted_by_stop = car.trip.stop && car.stood > 0.0});
  }
}

}  // namespace mvtp
