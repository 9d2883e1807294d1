#include "tools/generate/parking_instance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "planner/problem/input_error.hpp"
#include "planner/solve.hpp"
#include "tools/generate/dice.hpp"
#include "tools/generate/open_lot.hpp"
#include "traci_bridge/sumo_frame.hpp"

namespace mvtp {
namespace {

constexpr double kMaxSpeed = 2.78;    // 10 km/h [m/s]
constexpr double kStep = 0.8;         // [s]: 2.2 m
constexpr double kSide = 40.0;        // of the lot from south to north [m]
constexpr double kRoad = 6.5;         // width of each road, two lanes [m]
constexpr double kPitch = 7.7;        // of cars one behind the other [m]: a van and 1.8 m
constexpr double kGap = 1.0;          // from the first bumper to the end of the road [m]
constexpr double kDigits = 1e3;       // whole millimetres
constexpr double kAngleDigits = 1e4;  // whole 1e-4 rad
constexpr double kAside = 0.4;        // a slot is at least so much wider than its car [m]
constexpr int kAttempts = 20;         // to draw an instance in which all find a path alone

double rounded(double value, double digits) { return std::round(digits * value) / digits; }

Pose rounded(const Pose& pose) {
  return {rounded(pose.x, kDigits), rounded(pose.y, kDigits), rounded(pose.theta, kAngleDigits)};
}

/// The sizes on the lot, the longest first, and the share of cars that are so large among those in
/// whose slots they fit [%]; the rest is smaller.
struct Size {
  double length = 0.0;
  double width = 0.0;
  int percent = 100;
};
constexpr std::array<Size, 5> kSizes = {
    {{5.9, 2.0, 40}, {5.2, 1.9, 40}, {4.8, 1.85, 25}, {4.5, 1.8, 55}, {4.3, 1.75, 100}}};

/// A vehicle in millimetres, so that no digit depends on the machine.
Vehicle vehicle_of(const Size& size) {
  Vehicle vehicle = body_of(size.length, size.width);
  for (double* value : {&vehicle.front, &vehicle.rear, &vehicle.width, &vehicle.wheelbase}) {
    *value = rounded(*value, kDigits);
  }
  vehicle.min_turning_radius = std::ceil(100 * vehicle.min_turning_radius) / 100;
  vehicle.max_speed = kMaxSpeed;
  return vehicle;
}

/// The rear axle of a vehicle whose body has its middle there.
Pose centred(const Vehicle& vehicle, const Pose& middle) {
  return rounded(compose(middle, {-(vehicle.front - vehicle.rear) / 2, 0.0, 0.0}));
}

class ParkingScene {
 public:
  ParkingScene(const ParkingCell& cell, Dice& dice) : cell_(cell), dice_(dice), lot_(open_lot()) {
    const int rows = (std::max(cell.in, cell.out) + 1) / 2;
    road_ = rounded(2 * kGap + kPitch * rows, kDigits);
    for (ParkingSlot& slot : lot_.slots) slot.middle.x += road_;
    for (Polygon& island : lot_.obstacles) {
      for (Point& corner : island) corner.x += road_;
    }
  }

  [[nodiscard]] Instance draw() {
    Instance instance{.agents = {}, .map = empty_lot(), .dt = kStep};
    dice_.shuffle(lot_.slots);
    const std::span slots(lot_.slots);
    const auto in = std::size_t(cell_.in);
    const auto out = std::size_t(cell_.out);
    add_arriving(instance, slots.first(in));
    add_leaving(instance, slots.subspan(in, out));
    for (const ParkingSlot& slot : slots.subspan(in + out)) add_staying(instance, slot);
    return instance;
  }

 private:
  [[nodiscard]] Map empty_lot() const {
    Map map;
    map.width = road_ + lot_.ground[1].x;
    map.height = kSide;
    map.polygons = lot_.obstacles;
    map.polygons.push_back(
        {{0.0, kRoad}, {road_, kRoad}, {road_, kSide - kRoad}, {0.0, kSide - kRoad}});
    return map;
  }

  void add_arriving(Instance& instance, std::span<const ParkingSlot> slots) {
    for (std::size_t i = 0; i < slots.size(); ++i) {
      const Vehicle vehicle = any_vehicle(slots[i]);
      const double x = road_ - kGap - kPitch * double(i / 2) - vehicle.front;
      const double y = kRoad * (i % 2 == 0 ? 0.25 : 0.75);
      instance.agents.push_back(
          {fmt::format("in{}", i), vehicle, rounded({x, y, 0.0}), in_slot(vehicle, slots[i])});
    }
  }

  void add_leaving(Instance& instance, std::span<ParkingSlot> slots) {
    const Pose mouth{road_, kSide - kRoad / 2, 0.0};
    std::ranges::stable_sort(slots, {},
                             [&](const ParkingSlot& slot) { return distance(slot.middle, mouth); });
    for (std::size_t i = 0; i < slots.size(); ++i) {
      const Vehicle vehicle = any_vehicle(slots[i]);
      const double x = kGap + kPitch * double(i / 2) + vehicle.front;
      const double y = kSide - kRoad * (i % 2 == 0 ? 0.25 : 0.75);
      instance.agents.push_back({fmt::format("out{}", i), vehicle, in_slot(vehicle, slots[i]),
                                 rounded({x, y, std::numbers::pi})});
    }
  }

  void add_staying(Instance& instance, const ParkingSlot& slot) {
    const Vehicle vehicle = any_vehicle(slot);
    const Pose pose = in_slot(vehicle, slot);
    Polygon body;
    for (const auto& [x, y] : {Point{-vehicle.rear, -vehicle.width / 2},
                               {vehicle.front, -vehicle.width / 2},
                               {vehicle.front, vehicle.width / 2},
                               {-vehicle.rear, vehicle.width / 2}}) {
      const Pose corner = rounded(compose(pose, {x, y, 0.0}));
      body.push_back({corner.x, corner.y});
    }
    instance.map.polygons.push_back(std::move(body));
  }

  /// One that fits into the slot.
  [[nodiscard]] Vehicle any_vehicle(const ParkingSlot& slot) {
    for (const Size& size : kSizes) {
      const bool fits = size.length <= slot.length && size.width + kAside <= slot.width;
      if (fits && dice_.between(1, 100) <= size.percent) return vehicle_of(size);
    }
    return vehicle_of(kSizes.back());
  }

  /// In the middle of the slot, forward or in reverse.
  [[nodiscard]] Pose in_slot(const Vehicle& vehicle, const ParkingSlot& slot) {
    Pose middle = slot.middle;
    if (dice_.between(0, 1) == 1) middle.theta = wrap_to_pi(middle.theta + std::numbers::pi);
    return centred(vehicle, middle);
  }

  const ParkingCell& cell_;
  Dice& dice_;
  ParkingLot lot_;
  double road_ = 0.0;  ///< length of either road [m]
};

}  // namespace

void check_parking_cell(const ParkingCell& cell) {
  const auto slots = int(open_lot().slots.size());
  const std::string where = fmt::format("--in {} and --out {}", cell.in, cell.out);
  if (cell.in + cell.out < 1) throw InputError(where, "nobody comes or goes; give at least one");
  if (cell.in + cell.out > slots) {
    throw InputError(where, fmt::format("the lot has {0} slots; give at most {0} together", slots));
  }
}

GeneratedInstance generate_parking(const ParkingCell& cell, std::uint64_t seed, int index) {
  check_parking_cell(cell);
  Dice dice{low_word(seed), high_word(seed), low_word(cell.in), low_word(cell.out),
            low_word(index)};
  const std::string origin = fmt::format("parking, seed {}, instance {} of its cell", seed, index);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    Instance instance = ParkingScene(cell, dice).draw();
    if (robots_without_single_agent_path(instance).empty()) return {std::move(instance), origin};
  }
  throw InputError(origin,
                   "no instance was found in which each car has a single-agent path; give "
                   "another --seed");
}

std::string file_name(const ParkingCell& cell, int index) {
  return fmt::format("parking_in{:02}_out{:02}_ex{:02}.yaml", cell.in, cell.out, index);
}

}  // namespace mvtp
