// What a replanning session has found becomes a motion: paths, and the order of passage.

#include <algorithm>
#include <cmath>

#include "planner/lot/replanning_session.hpp"

namespace mvtp {
namespace {

constexpr double kNever = 1e9;
constexpr float kNow = -1.0F;  ///< when a car is where it is: before all that is planned

}  // namespace

ArcPath LotPlanner::ReplanningSession::path_of(int robot, const ArcTrajectory& trajectory) const {
  const Robot& r = robots_[std::size_t(robot)];
  ArcPath path = r.prefix;
  path.append(trajectory.steps());
  if (r.leaves) path.append({Arc{kRunOut, 0.0}});
  return path;
}

LotCar LotPlanner::ReplanningSession::car(int robot, const ArcTrajectory& trajectory) const {
  const Robot& r = robots_[std::size_t(robot)];
  LotCar car;
  car.key = r.key;
  car.body = r.body;
  car.path = path_of(robot, trajectory);
  car.goal = r.goal;
  car.leaves = r.leaves;
  car.s = r.s;
  car.v = r.v;
  return car;
}

double LotPlanner::ReplanningSession::duration_alone(int robot,
                                                     const ArcTrajectory& trajectory) const {
  LotMotion motion(planner_.options_.limits);
  motion.put(car(robot, trajectory));
  return motion.forecast().arrival(0);
}

std::vector<float> LotPlanner::ReplanningSession::times_of_kept(int i) const {
  const auto k = std::size_t(i);
  const LotCar& car = motion_.cars()[k];
  const std::vector<float>& driven = forecast_.driven[k];
  std::vector<float> times(std::size_t(car.cells.size()), float(kNever));
  std::size_t step = 0;
  for (std::size_t c = 0; c < times.size(); ++c) {
    const double middle = std::min((double(c) + 0.5) * PathCells::kLength, car.path.length());
    while (step < driven.size() && double(driven[step]) < middle - 1e-4) ++step;
    if (step == driven.size()) break;
    times[c] = float(double(step) * forecast_.dt);
  }
  times[std::size_t(car.cells.cell_at(car.s))] = kNow;
  return times;
}

std::vector<float> LotPlanner::ReplanningSession::times_of_planned(const LotCar& car,
                                                                   int robot) const {
  const Robot& r = robots_[std::size_t(robot)];
  const double prefix = r.prefix.length();
  std::vector<float> times(std::size_t(car.cells.size()), float(kNever));
  const std::vector<Arc>& steps = trajectory(robot).steps();
  std::size_t step = 0;
  double s = prefix;
  for (std::size_t c = 0; c < times.size(); ++c) {
    const double middle = std::min((double(c) + 0.5) * PathCells::kLength, car.path.length());
    if (middle < prefix) {
      // Evenly over the time until the session begins; the forecast knows better for cars under
      // path.
      const double part = (middle - r.s) / std::max(prefix - r.s, 1e-6);
      times[c] = float(ahead() * std::max(0.0, part));
      if (robot < cars()) {
        const std::vector<float>& driven = forecast_.driven[std::size_t(robot)];
        const auto at = std::ranges::lower_bound(driven, float(middle));
        times[c] = float(double(at - driven.begin()) * forecast_.dt);
      }
      continue;
    }
    while (step < steps.size() && s < middle - 1e-4) s += std::abs(steps[step++].length);
    times[c] = float(ahead() + double(step) * planner_.time_.dt);
    if (s < middle - 1e-4) times[c] += float((middle - s) / planner_.options_.limits.speed);
  }
  times[std::size_t(car.cells.cell_at(car.s))] = kNow;
  return times;
}

LotMotion LotPlanner::ReplanningSession::result(std::span<const int> changed) const {
  LotMotion result = motion_;
  struct TimedCar {
    std::int64_t key;
    std::vector<float> times;
    bool changed;
  };
  std::vector<TimedCar> timed;
  for (int i = 0; i < cars(); ++i) {
    if (std::ranges::find(changed, i) != changed.end()) continue;
    timed.push_back({robots_[std::size_t(i)].key, times_of_kept(i), false});
  }
  for (const int i : changed) {
    LotCar now = car(i, trajectory(i));
    now.cells = PathCells(now.path, now.body, planner_.options_.gap);
    now.cells.keep_clear(planner_.footpaths_);
    timed.push_back({now.key, times_of_planned(now, i), true});
    result.put(std::move(now));
  }
  const auto planned = [&](const TimedCar& of) {
    const LotCar& car = result.cars()[std::size_t(result.find(of.key))];
    return CellSchedule{&car.cells, car.cells.cell_at(car.s), of.times};
  };
  for (std::size_t i = 0; i < timed.size(); ++i) {
    for (std::size_t j = i + 1; j < timed.size(); ++j) {
      if (!timed[i].changed && !timed[j].changed) continue;
      auto [first, second] = precedence(planned(timed[i]), planned(timed[j]));
      result.set_order(timed[i].key, timed[j].key, std::move(first));
      result.set_order(timed[j].key, timed[i].key, std::move(second));
    }
  }
  return result;
}

}  // namespace mvtp
