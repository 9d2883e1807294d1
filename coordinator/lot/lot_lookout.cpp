#include "coordinator/lot/lot_lookout.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "planner/lot.hpp"

namespace mvtp {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLookahead = 4.0;      ///< [m] beyond the braking distance
constexpr double kDistance = 0.6;       ///< [m] kept from people
constexpr double kTimeStep = 0.25;      ///< [s]
constexpr double kSlackOutside = 1.2;   ///< [s] between a car and a person at one place, and
constexpr double kSlackInside = 0.3;    ///< [s] where a car is on a footpath already
constexpr double kRoomAhead = 0.3;      ///< [m] between a stopping point and what it is for
constexpr double kHesitation = 1.5;     ///< times what it takes at best
constexpr double kBeside = 0.2;         ///< [m] from people who walk past a car that stands
constexpr double kPassing = 8.0;        ///< [s] that this may take
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

/// Where the car comes to rest if it brakes now [m].
double rest(const LotCar& car, const LotLimits& limits) {
  return car.s + stopping_distance(car.v, limits.braking);
}

/// Would it come to rest behind the beginning of a cell?
bool too_late_for(int cell, const LotCar& car, const LotLimits& limits) {
  return rest(car, limits) > cell * PathCells::kLength;
}

}  // namespace

/// One car's view of what is ahead.
struct LotLookout::Look {
  const LotMotion& motion;
  const LotCar& car;
  double turn;
  const View& view;
  int here;
  int last;     ///< cell
  bool inside;  ///< of a footpath, or too close to it to stop: then it crosses without delay

  [[nodiscard]] double time_to(int cell) const {
    const double distance = std::max(0.0, cell * PathCells::kLength - car.s);
    return fastest(distance, car.v, motion.limits());
  }

  /// Is the person close to a cell while the car is there?
  [[nodiscard]] bool meets(const Pedestrian& person, int cell, double slack,
                           double hesitation) const {
    const double leaves = hesitation * time_to(cell + 1);
    for (double t = std::max(0.0, time_to(cell) - slack); t <= leaves + slack; t += kTimeStep) {
      if (near(car, cell, after(person, t), person.radius + kDistance)) return true;
    }
    return false;
  }

  /// Does the person walk into the car if it stands in a cell?
  [[nodiscard]] bool walks_into(const Pedestrian& person, int cell) const {
    for (double t = 0.0; t <= kPassing; t += kTimeStep) {
      if (near(car, cell, after(person, t), person.radius + kBeside)) return true;
    }
    return false;
  }

  /// Where it can stop ahead of a cell and let the person pass [m]; nullopt if it is too late.
  [[nodiscard]] std::optional<double> place_to_wait(const Pedestrian& person, int cell) const {
    const double soonest = rest(car, motion.limits()) - kRoomAhead;
    for (int k = cell; before(k) >= std::max(soonest, 0.0); --k) {
      if (!walks_into(person, car.cells.cell_at(before(k)))) return before(k);
    }
    return std::nullopt;
  }
};

double LotLookout::stopping_point(const LotMotion& motion, const LotCar& car, double turn,
                                  const View& view) {
  if (car.at_end()) return kInfinity;
  const double lookahead = rest(car, motion.limits()) + kLookahead;
  const int here = car.cells.cell_at(car.s);
  const bool inside = std::ranges::any_of(car.cells.kept_clear(), [&](const auto& stretch) {
    return here <= stretch.last && too_late_for(stretch.first, car, motion.limits());
  });
  const Look look{motion, car, turn, view, here, car.cells.cell_at(lookahead), inside};
  return std::min({before_people(look), before_footpath(look), before_strangers(look)});
}

double LotLookout::before_people(const Look& look) {
  const double slack = look.inside ? kSlackInside : kSlackOutside;
  double stopping_point = kInfinity;
  for (const Pedestrian& person : look.view.people) {
    for (int cell = look.here + 1; cell <= look.last; ++cell) {
      if (before(cell) >= stopping_point) break;
      if (!look.meets(person, cell, slack, kHesitation)) continue;
      if (const std::optional<double> place = look.place_to_wait(person, cell)) {
        stopping_point = std::min(stopping_point, *place);
      } else if (look.meets(person, cell, kSlackInside, 1.0)) {
        stopping_point = before(cell);
      }
    }
  }
  return stopping_point;
}

double LotLookout::before_footpath(const Look& look) {
  const LotCar& car = look.car;
  const auto next = std::ranges::find_if(car.cells.kept_clear(), [&](const auto& stretch) {
    return !too_late_for(stretch.first, car, look.motion.limits());
  });
  if (look.view.people.empty() || next == car.cells.kept_clear().end()) return kInfinity;
  if (next->first > look.last) return kInfinity;
  const auto [first, last] = *next;
  const double enters = look.motion.time_until(car, first * PathCells::kLength, look.turn);
  const double leaves = look.motion.time_until(car, (last + 1) * PathCells::kLength, look.turn);
  if (!std::isfinite(leaves)) return before(first);
  for (const Pedestrian& person : look.view.people) {
    for (double t = std::max(0.0, enters - kSlackOutside); t <= leaves + kSlackOutside;
         t += kTimeStep) {
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
