#include "tests/coordinator/fake_lot.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mvtp {
namespace {

constexpr double kLane = 60.0;    // [m]
constexpr double kSpeed = 5.0;    // [m/s]
constexpr double kGap = 2.5;      // [m]
constexpr double kBraking = 3.0;  // [m/s^2]

}  // namespace

ParkingLot make_lot() {
  ParkingLot lot;
  lot.id = "lot";
  lot.ground = {{0, 0}, {26, 0}, {26, 18}, {0, 18}, {0, 13.5}, {-28, 13.5}, {-28, 4.5}, {0, 4.5}};
  for (int row = 0; row < 2; ++row) {
    for (int k = 0; k < 8; ++k) {
      ParkingSlot slot;
      slot.id = "s" + std::to_string(8 * row + k);
      slot.middle = {2.0 + 2.5 * k, row == 0 ? 2.5 : 15.5,
                     row == 0 ? -std::numbers::pi / 2 : std::numbers::pi / 2};
      lot.slots.push_back(slot);
    }
  }
  lot.entries.push_back({"in_0", {-28, 6.5, 0}, 28, kLane - 28});
  lot.exits.push_back({"out_0", {0, 11.5, std::numbers::pi}, 28, 0});
  return lot;
}

Vehicle lot_car() {
  return {.front = 3.6,
          .rear = 0.9,
          .width = 1.8,
          .wheelbase = 2.7,
          .min_turning_radius = 3.83,
          .max_speed = 50.0,
          .max_accel = 2.6,
          .max_decel = 4.5};
}

FakeLotTraffic::FakeLotTraffic(const ParkingLot& lot, std::vector<FakeParkingEvent> events)
    : lot_(lot), events_(std::move(events)) {
  std::ranges::stable_sort(events_, {}, &FakeParkingEvent::depart);
  refresh();
}

VehicleType FakeLotTraffic::type(const std::string& id) const { return {.id = id, .body = body_}; }

std::optional<ParkingStop> FakeLotTraffic::parking_stop(const std::string& id) const {
  const FakeParkingEvent& event = cars_.at(id).event;
  return ParkingStop{.area = "lot", .duration = event.duration, .parked = event.slot >= 0};
}

void FakeLotTraffic::hand_back(const std::string& id) {
  Car& car = cars_.at(id);
  car.placed = false;
  car.going = true;
  car.front = -car.pose.x + body_.front;
}

void FakeLotTraffic::place(const std::string& id, const Pose& pose, double speed) {
  Car& car = cars_.at(id);
  car.pose = pose;
  car.speed = speed;
}

void FakeLotTraffic::drive_own(Car& car, double room) const {
  const double safe = std::sqrt(2 * kBraking * std::max(0.0, room - 0.1 * car.speed));
  car.speed = std::clamp(std::min({kSpeed, safe, car.cap}), car.speed - 0.45, car.speed + 0.26);
  car.speed = std::max(car.speed, 0.0);
  car.front += 0.1 * car.speed;
}

void FakeLotTraffic::step() {
  time_ += 0.1;
  for (Pedestrian& p : people_) {
    p.position.x += 0.1 * p.speed * std::cos(p.theta);
    p.position.y += 0.1 * p.speed * std::sin(p.theta);
  }
  double leader = kLane + kGap;
  std::vector<std::string> left;
  for (const FakeParkingEvent& event : events_) {  // in the order of their departure
    const auto found = cars_.find(event.id);
    if (found == cars_.end()) continue;
    Car& car = found->second;
    // As in SUMO: whose front has left the lane does not count for those who follow.
    const bool in_strip = car.pose.x + body_.front < 0.0 && std::abs(car.pose.y - 6.5) < 2.0;
    if (car.placed && in_strip) leader = std::min(leader, car.pose.x - body_.rear + kLane);
    if (car.placed || (event.slot >= 0 && !car.going)) continue;
    if (car.going) {
      drive_own(car, 1e3);
      car.pose = {-car.front + body_.front, 11.5, std::numbers::pi};
      if (car.front > kLane) left.push_back(event.id);
    } else {
      drive_own(car, leader - kGap - car.front);
      car.pose = {car.front - kLane - body_.front, 6.5, 0.0};
      leader = car.front - body_.length();
    }
  }
  for (const std::string& id : left) cars_.erase(id);
  arrived_ += int(left.size());
  while (next_ < events_.size() && events_[next_].depart <= time_) {
    const FakeParkingEvent& event = events_[next_];
    if (event.slot < 0 && leader < 2 * body_.length()) break;
    Car car{.event = event,
            .pose = {body_.length() - kLane - body_.front, 6.5, 0.0},
            .front = body_.length()};
    car.speed = event.slot < 0 ? kSpeed : 0.0;
    if (event.slot >= 0) {
      const Pose& middle = lot_.slots[std::size_t(event.slot)].middle;
      car.pose = compose(middle, {-(body_.front - body_.rear) / 2, 0, 0});
    } else {
      leader = 0.0;
    }
    cars_.emplace(event.id, car);
    ++next_;
  }
  refresh();
}

void FakeLotTraffic::refresh() {
  states_.clear();
  for (const auto& [id, car] : cars_) {
    VehicleState state{.id = id, .type = "car", .pose = car.pose, .speed = car.speed};
    if (car.going || (!car.placed && car.event.slot < 0)) {
      state.lane = car.going ? "out_0" : "in_0";
      state.lane_position = car.front;
    }
    states_.push_back(state);
  }
}

}  // namespace mvtp
