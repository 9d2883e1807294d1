#include "tests/coordinator/fake_traffic.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace mvtp {
namespace {

constexpr double kHalf = 7.2;   // [m] from the centre to the stop lines
constexpr double kAside = 1.6;  // [m] from the middle of the road to the lanes' centre lines
const std::array<std::string, 4> kArms = {"W", "S", "E", "N"};

Point turned(Point p, int quarters) {
  for (int i = 0; i < quarters; ++i) p = {-p.y, p.x};
  return p;
}

Lane make_lane(const std::string& edge, std::vector<Point> shape, int quarters, bool internal) {
  Lane lane{.id = edge + "_0", .edge = edge, .internal = internal};
  for (Point& p : shape) p = turned(p, quarters);
  for (std::size_t i = 1; i < shape.size(); ++i) {
    lane.length += std::hypot(shape[i].x - shape[i - 1].x, shape[i].y - shape[i - 1].y);
  }
  lane.shape = std::move(shape);
  if (internal && lane.shape.size() > 2) lane.speed_limit = 6.5;
  return lane;
}

std::vector<Point> arc(Point centre, double radius, double from, double to) {
  std::vector<Point> points;
  for (int i = 0; i <= 8; ++i) {
    const double a = from + (to - from) * i / 8.0;
    points.push_back({centre.x + radius * std::cos(a), centre.y + radius * std::sin(a)});
  }
  return points;
}

double path_length(const std::vector<Point>& shape) {
  double length = 0.0;
  for (std::size_t i = 1; i < shape.size(); ++i) {
    length += std::hypot(shape[i].x - shape[i - 1].x, shape[i].y - shape[i - 1].y);
  }
  return length;
}

}  // namespace

RoadNetwork make_crossroads(double arm) {
  constexpr double kPi = std::numbers::pi;
  RoadNetwork network;
  Junction centre{.id = "C", .type = "priority", .has_conflicts = true};
  centre.shape = {{-kHalf, -3.2}, {-3.2, -kHalf}, {3.2, -kHalf}, {kHalf, -3.2},
                  {kHalf, 3.2},   {3.2, kHalf},   {-3.2, kHalf}, {-kHalf, 3.2}};
  const std::vector<Point> in = {{-arm, -kAside}, {-kHalf, -kAside}};
  const std::vector<Point> out = {{-kHalf, kAside}, {-arm, kAside}};
  const std::array<std::vector<Point>, 3> ways = {
      arc({-kHalf, -kHalf}, kHalf - kAside, kPi / 2, 0.0),
      {{-kHalf, -kAside}, {kHalf, -kAside}},
      arc({-kHalf, kHalf}, kHalf + kAside, -kPi / 2, 0.0)};
  const auto add = [&](Lane lane) {
    if (!lane.internal) network.edges[lane.edge] = {lane.id};
    network.lanes.emplace(lane.id, std::move(lane));
  };
  for (int k = 0; k < 4; ++k) {
    const std::string& from = kArms[std::size_t(k)];
    add(make_lane(from + "_in", in, k, false));
    add(make_lane(from + "_out", out, k, false));
    centre.incoming_lanes.push_back(from + "_in_0");
    for (int w = 0; w < 3; ++w) {
      const std::string& to = kArms[std::size_t((k + w + 1) % 4)];
      add(make_lane(":C_" + from + to, ways[std::size_t(w)], k, true));
      centre.connections.push_back({from + "_in_0", {":C_" + from + to + "_0"}, to + "_out_0"});
    }
  }
  network.junctions.emplace("C", std::move(centre));
  return network;
}

FakeTraffic::FakeTraffic(RoadNetwork network, std::vector<FakeTrip> trips, double step_length)
    : network_(std::move(network)), trips_(std::move(trips)), step_length_(step_length) {
  std::ranges::stable_sort(trips_, {}, &FakeTrip::depart);
}

VehicleType FakeTraffic::type(const std::string& id) const {
  return {.id = id,
          .body = {.front = 3.6,
                   .rear = 0.9,
                   .width = 1.8,
                   .wheelbase = 2.7,
                   .min_turning_radius = 3.86,
                   .max_speed = 55.0,
                   .max_accel = 2.6,
                   .max_decel = 4.5}};
}

std::vector<std::string> FakeTraffic::route(const std::string& id) const {
  const Car& car = cars_.at(id);
  if (lane_at(car).first == car.lanes.back()) return {car.trip.to};
  return {car.trip.from, car.trip.to};
}

void FakeTraffic::place(const std::string& id, const Pose& pose, double speed) {
  Car& car = cars_.at(id);
  car.pose = pose;
  car.speed = speed;
}

void FakeTraffic::hand_back(const std::string& id) { cars_.at(id).placed = false; }

void FakeTraffic::hold(const std::string& id, bool stop) {
  stop ? (void)held_.insert(id) : (void)held_.erase(id);
}

void FakeTraffic::step() {
  time_ += step_length_;
  insert_departures();
  for (auto& [id, car] : cars_) {
    if (!car.placed) {
      follow_leader(car);
      continue;
    }
    // A placed car is where it was put; its place on the lanes is the nearest to its front bumper.
    const Pose front = compose(car.pose, {3.6, 0.0, 0.0});
    double nearest = 1e300;
    const double guess = car.front;
    for (double s = guess - 0.5; s < guess + 3.5; s += 0.02) {
      const Point p = point_at(car, s);
      const double d = std::hypot(p.x - front.x, p.y - front.y);
      if (d < nearest) nearest = d, car.front = s;
    }
  }
  std::erase_if(cars_, [&](const auto& entry) {
    const bool there = entry.second.front >= length_of(entry.second.lanes);
    arrived_ += there ? 1 : 0;
    return there;
  });
  refresh();
}

void FakeTraffic::insert_departures() {
  for (; next_ < trips_.size() && trips_[next_].depart <= time_; ++next_) {
    const FakeTrip& trip = trips_[next_];
    Car car{.trip = trip, .front = 4.6, .speed = 13.89};
    const std::string in = trip.from + "_0";
    const std::string out = trip.to + "_0";
    for (const Connection& c : network_.junctions.at("C").connections) {
      if (c.from_lane == in && c.to_lane == out) car.lanes = {in, c.via[0], out};
    }
    // The entry is a gap that moves on: nobody is inserted into the rear of the car ahead.
    for (const auto& [id, other] : cars_) {
      if (other.lanes[0] == in && other.front < 30.0) return;
    }
    cars_.emplace(trip.id, std::move(car));
  }
}

void FakeTraffic::follow_leader(Car& car) const {
  const auto [lane, position] = lane_at(car);
  double room = 1e9;
  double leader_speed = 0.0;
  for (const auto& [id, other] : cars_) {
    if (&other == &car) continue;
    const auto [other_lane, other_position] = lane_at(other);
    const double gap = other_lane == lane ? other_position - position : 1e9;
    if (gap > 0.0 && gap - 7.0 < room) {
      room = gap - 7.0;
      leader_speed = other.speed;
    }
  }
  if (held_.contains(car.trip.id) && lane == car.lanes[0]) {
    const double to_line = network_.lanes.at(lane).length - 1.0 - position;
    if (to_line < room) room = to_line, leader_speed = 0.0;
  }
  // Krauss: the speed from which one can still stop behind a leader that brakes as hard.
  constexpr double kDecel = 4.5;
  const double safe = -kDecel + std::sqrt(kDecel * kDecel + leader_speed * leader_speed +
                                          2.0 * kDecel * std::max(0.0, room));
  const double limit = network_.lanes.at(lane).speed_limit;
  double speed = std::min({car.speed + 2.6 * step_length_, limit, safe});
  speed = std::max(speed, car.speed - kDecel * step_length_);
  car.speed = frozen_.contains(car.trip.id) ? std::max(0.0, car.speed - kDecel * step_length_)
                                            : std::max(0.0, speed);
  car.front += car.speed * step_length_;
}

void FakeTraffic::refresh() {
  states_.clear();
  for (auto& [id, car] : cars_) {
    if (!car.placed) {
      const Point front = point_at(car, car.front);
      const Point back = point_at(car, car.front - 4.5);
      const double theta = std::atan2(front.y - back.y, front.x - back.x);
      car.pose = compose({front.x, front.y, theta}, {-3.6, 0.0, 0.0});
    }
    const auto [lane, position] = lane_at(car);
    states_.push_back({.id = id,
                       .type = "car",
                       .pose = car.pose,
                       .speed = car.speed,
                       .lane = lane,
                       .lane_position = position});
  }
}

Point FakeTraffic::point_at(const Car& car, double s) const {
  std::vector<Point> line;
  for (const std::string& id : car.lanes) {
    const auto& shape = network_.lanes.at(id).shape;
    line.insert(line.end(), shape.begin(), shape.end());
  }
  for (std::size_t i = 1; i < line.size(); ++i) {
    const double length = std::hypot(line[i].x - line[i - 1].x, line[i].y - line[i - 1].y);
    if (length < 1e-9) continue;
    if (s <= length || i + 1 == line.size()) {
      const double f = s / length;
      return {line[i - 1].x + f * (line[i].x - line[i - 1].x),
              line[i - 1].y + f * (line[i].y - line[i - 1].y)};
    }
    s -= length;
  }
  return line.back();
}

std::pair<std::string, double> FakeTraffic::lane_at(const Car& car) const {
  double s = car.front;
  for (const std::string& id : car.lanes) {
    const double length = path_length(network_.lanes.at(id).shape);
    if (s < length || id == car.lanes.back()) return {id, s};
    s -= length;
  }
  return {car.lanes.back(), s};
}

double FakeTraffic::length_of(const std::vector<std::string>& lanes) const {
  double length = 0.0;
  for (const std::string& id : lanes) length += path_length(network_.lanes.at(id).shape);
  return length;
}

}  // namespace mvtp
