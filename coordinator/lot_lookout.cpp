#include "coordinator/lot_lookout.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "planner/motion/inertial_car.hpp"

namespace mvtp {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSight = 4.0;          ///< [m] beyond the braking distance
constexpr double kDistance = 0.6;       ///< [m] kept from people
constexpr double kInstant = 0.25;       ///< [s]
constexpr double kSlackOutside = 1.2;   ///< [s] between a car and a person at one place, and
constexpr double kSlackInside = 0.3;    ///< [s] where a car is on a footpath already
constexpr double kRoomAhead = 0.3;      ///< [m] between a halt and what it is for
constexpr double kFromStrangers = 0.5;  ///< [m]

/// [s] to drive `distance` from speed `v`, at best.
double fastest(double distance, double v, const LotLimits& limits) {
  const double reached = std::max(0.0, (limits.speed * limits.speed - v * v) / (2 * limits.accel));
  if (distance <= reached) {
    return (std::sqrt(v * v + 2 * limits.accel * distance) - v) / limits.accel;
  }
  return (limits.speed - v) / limits.accel + (distance - reached) / limits.speed;
}

Point after(const Pedestrian& p, double time) {
  return {p.position.x + p.speed * time * std::cos(p.theta),
          p.position.y + p.speed * time * std::sin(p.theta)};
}

bool near(const LotCar& car, int cell, const Point& point, double distance) {
  const BoxPose& box = car.cells.box(cell);
  const BoxShape& shape = car.cells.shape(cell);
  const double dx = point.x - double(box.x);
  const double dy = point.y - double(box.y);
  const double along =
      std::abs(dx * double(box.ux) + dy * double(box.uy)) - double(shape.half_length);
  const double across =
      std::abs(dy * double(box.ux) - dx * double(box.uy)) - double(shape.half_width);
  return std::hypot(std::max(along, 0.0), std::max(across, 0.0)) < distance;
}

/// The last place before a cell where the car should stand [m].
double before(int cell) { return cell * PathCells::kLength - kRoomAhead; }

}  // namespace

/// One car's view of what is ahead.
struct LotLookout::Look {
  const LotMotion& motion;
  const LotCar& car;
  double turn;
  const View& view;
  int here;
  int last;     ///< cell
  bool inside;  ///< of a footpath

  [[nodiscard]] double time_to(int cell) const {
    const double distance = std::max(0.0, cell * PathCells::kLength - car.s);
    return fastest(distance, car.v, motion.limits());
  }
};

double LotLookout::halt(const LotMotion& motion, const LotCar& car, double turn, const View& view) {
  if (car.at_end()) return kInfinity;
  const double sight = car.s + stopping_distance(car.v, motion.limits().braking) + kSight;
  const int here = car.cells.cell_at(car.s);
  const bool inside = std::ranges::any_of(car.cells.stretches(), [here](const auto& stretch) {
    return stretch.first <= here && here <= stretch.last;
  });
  const Look look{motion, car, turn, view, here, car.cells.cell_at(sight), inside};
  return std::min({before_people(look), before_footpath(look), before_strangers(look)});
}

double LotLookout::before_people(const Look& look) {
  const double slack = look.inside ? kSlackInside : kSlackOutside;
  double halt = kInfinity;
  for (const Pedestrian& person : look.view.people) {
    for (int cell = look.here + 1; cell <= look.last; ++cell) {
      if (before(cell) >= halt) break;
      const double enters = look.time_to(cell);
      const double leaves = 1.5 * look.time_to(cell + 1);
      bool meets = false;
      for (double t = std::max(0.0, enters - slack); t <= leaves + slack && !meets; t += kInstant) {
        meets = near(look.car, cell, after(person, t), person.radius + kDistance);
      }
      if (meets) halt = before(cell);
    }
  }
  return halt;
}

double LotLookout::before_footpath(const Look& look) {
  const LotCar& car = look.car;
  const auto next = std::ranges::find_if(
      car.cells.stretches(), [&](const auto& stretch) { return stretch.first > look.here; });
  if (look.view.people.empty() || next == car.cells.stretches().end()) return kInfinity;
  if (next->first > look.last) return kInfinity;
  const auto [first, last] = *next;
  const double enters = look.motion.time_until(car, first * PathCells::kLength, look.turn);
  const double leaves = look.motion.time_until(car, (last + 1) * PathCells::kLength, look.turn);
  if (!std::isfinite(leaves)) return before(first);
  for (const Pedestrian& person : look.view.people) {
    for (double t = std::max(0.0, enters - kSlackOutside); t <= leaves + kSlackOutside;
         t += kInstant) {
      const Point place = after(person, t);
      for (int cell = first; cell <= last; ++cell) {
        if (near(car, cell, place, person.radius + kDistance)) return before(first);
      }
    }
  }
  return kInfinity;
}

double LotLookout::before_strangers(const Look& look) {
  for (int cell = look.here + 1; cell <= look.last; ++cell) {
    BoxShape grown = look.car.cells.shape(cell);
    grown.half_length += float(kFromStrangers);
    for (const StandingCar& stranger : look.view.strangers) {
      const BoxShape body{float(stranger.body.length() / 2), float(stranger.body.width / 2), 0.0F};
      const BoxPose pose = box_pose(stranger.body, stranger.pose);
      if (gap(look.car.cells.box(cell), grown, pose, body) < 0.0F) return before(cell);
    }
  }
  return kInfinity;
}

}  // namespace mvtp
