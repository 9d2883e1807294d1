#include "coordinator/prediction/tube.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mvtp {
namespace {

// What SUMO's drivers do (sigma 0 ... 0.5) lies between these: docs/experiments/mixed.md.
constexpr double kFastest = 1.01;    ///< share of the wanted speed
constexpr double kSlowest = 0.92;    ///< the same
constexpr double kLeastAccel = 0.6;  ///< share of the vehicle's acceleration
constexpr double kGentle = 0.6;      ///< share of its deceleration before lower limits
constexpr double kStart = 0.5;       ///< [s] until one that stands moves at its green
constexpr double kLateFollow = 0.5;  ///< [s] of headway beside his own
constexpr double kLeastGap = 1.0;    ///< [m] that a follower keeps, more than any margin
constexpr double kHorizon = 100.0;   ///< [s] as that of plans
constexpr double kVisibility = 4.5;  ///< [m] before a waiting place he sees who comes [sumo]

/// The speeds from which he can stop at each place where he may wait, until he sees that he need
/// not.
SpeedEnvelope before_waiting_places(const TubeDriver& driver) {
  std::vector<double> limits(driver.limits.size(), 1e9);
  for (const double place : driver.waiting_places) {
    const double i = std::round((place - kVisibility) / ReferencePath::kSpacing);
    const bool is_ahead = i >= 0.0 && i < double(limits.size());
    if (is_ahead) limits[std::size_t(i)] = std::sqrt(2.0 * driver.max_decel * kVisibility);
  }
  return {std::move(limits), driver.max_decel};
}

/// How far a leader has come `steps` after now [m]; before now it kept its speed.
double travelled(const TubeLeader& leader, const SpeedProfile* t, bool latest, double steps,
                 double dt) {
  const double time = steps * dt;
  if (t == nullptr && !latest) return (leader.speed + 0.5 * leader.max_accel * time) * time;
  if (t == nullptr || steps <= 0.0) return leader.speed * time;
  return t->at(t->begin + std::int64_t(steps)).s - t->states.front().s;
}

/// How far the driver may come at most, or at least, behind his leaders [m].
double room_behind(const std::vector<TubeLeader>& leaders, double k, double dt, bool latest,
                   double lag, double distance) {
  double room = 1e9;
  for (const TubeLeader& leader : leaders) {
    const SpeedProfile* t = latest ? leader.latest : leader.earliest;
    const double driven = travelled(leader, t, latest, k - lag / dt, dt);
    if (driven >= leader.until) continue;
    room = std::min(room, leader.gap - distance + driven);
  }
  return room;
}

}  // namespace

double braking_gap(double speed, double decel, double dt) {
  const double steps = std::floor(speed / (decel * dt));
  return dt * (steps * speed - decel * dt * steps * (steps + 1.0) / 2.0);
}

SpeedEnvelope drivers_envelope(std::vector<double> limits, double share, double braking) {
  constexpr double kLeast = 0.5;  // [m/s]
  for (double& limit : limits) limit = std::max(kLeast, limit * share);
  return {std::move(limits), braking};
}

Tube predict_tube(const TubeDriver& driver, const std::vector<TubeLeader>& leaders,
                  const DecisionGrid& grid, std::int64_t step) {
  const SpeedEnvelope fast = drivers_envelope(driver.limits, kFastest, driver.max_decel);
  const SpeedEnvelope slow = drivers_envelope(driver.limits, kSlowest, kGentle * driver.max_decel);
  const SpeedEnvelope careful = before_waiting_places(driver);
  const RoadVehicle& road = driver.road;
  const auto drive = [&](bool latest) {
    SpeedProfile t{.begin = step, .states = {road.now}};
    const double most = latest ? kLeastAccel * driver.max_accel : driver.max_accel;
    const double lag = latest ? road.tau + kLateFollow : 0.0;
    const double distance = latest ? road.min_gap : std::min(road.min_gap, kLeastGap);
    const int waits = latest && road.now.v < 0.1 ? int(std::lround(kStart / grid.dt)) : 0;
    const auto longest = std::size_t(kHorizon / grid.dt);
    while (t.states.back().s < road.s_end && t.states.size() < longest) {
      const InertialState last = t.states.back();
      const double ahead = last.s + last.v * grid.dt;
      const double wanted = latest ? std::min(slow.at(ahead), careful.at(ahead)) : fast.at(ahead);
      double a = std::clamp((wanted - last.v) / grid.dt, -driver.max_decel, most);
      if (int(t.states.size()) <= waits) a = 0.0;
      InertialState next = advance(last, a, grid.dt);
      // SUMO drives a whole step at the speed that it has at the step's end (Euler).
      if (!latest && a > 0.0) next.s = last.s + next.v * grid.dt;
      double room = room_behind(leaders, double(t.states.size()), grid.dt, latest, lag, distance);
      const std::int64_t k = step + std::int64_t(t.states.size());
      const bool stands = latest && k <= driver.yields_until;
      if (stands) room = std::min(room, std::max(0.0, driver.line - road.min_gap - road.now.s));
      if (next.s > road.now.s + room) {
        next.s = std::max(last.s, road.now.s + room);
        next.v = (next.s - last.s) / grid.dt;
      }
      t.states.push_back(next);
    }
    return t;
  };
  return {.earliest = drive(false), .latest = drive(true)};
}

bool may_meet(const ContactTable& contacts, const TubeView& a, double a_end, const TubeView& b,
              double b_end, std::int64_t step, int before, int behind) {
  if (contacts.empty()) return false;
  for (std::int64_t k = step;; ++k) {
    const double a_late = a.latest.at(k - behind).s;
    const double b_late = b.latest.at(k).s;
    if (a_late > a_end || b_late > b_end) return false;
    const double a_early = std::min(a_end, a.earliest.at(k + 1 + before).s);
    const double b_early = std::min(b_end, b.earliest.at(k + 1).s);
    if (contacts.meets(a_late, std::max(a_late, a_early), b_late, std::max(b_late, b_early))) {
      return true;
    }
    // Both have stopped for good: nothing changes any more.
    const bool over = k - behind >= a.latest.end() && k >= b.latest.end();
    if (over) return false;
  }
}

}  // namespace mvtp
