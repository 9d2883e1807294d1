#include "tests/coordinator/fake_traffic.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "coordinator/network/polyline.hpp"
#include "tests/coordinator/fake_drivers.hpp"

namespace mvtp {
namespace {

constexpr int kNone = LaneGraph::kNone;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Point lerp(const Point& a, const Point& b, double f) {
  return {a.x + f * (b.x - a.x), a.y + f * (b.y - a.y)};
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
  } else if (id == "close") {
    type.min_gap = 0.5;
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

void FakeTraffic::let_through(const std::string& id, Passage passage) {
  const auto found = cars_.find(id);
  if (found == cars_.end()) return;
  found->second.passes = passage != Passage::kNone;
  if (found->second.passes) ++passages_[id];
}

void FakeTraffic::rely_on_signal(const std::string& id, const std::vector<std::string>& waiting) {
  const auto found = cars_.find(id);
  if (found != cars_.end()) found->second.waiting = {waiting.begin(), waiting.end()};
}

bool FakeTraffic::is_held(const std::string& id) const {
  const auto car = cars_.find(id);
  return car != cars_.end() && car->second.held_on != kNone;
}

std::string FakeTraffic::next_lane(const std::string& id) const {
  const Car& car = cars_.at(id);
  const int link = is_normal(car.lane) ? link_from(car, car.lane, car.edge) : LaneGraph::kNone;
  return link == LaneGraph::kNone ? std::string() : graph_.lane(graph_.link(link).to).id;
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
