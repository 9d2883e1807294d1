#include "tools/toio/plan/path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

constexpr double kWait = 0.002;       // shorter steps are waits [m of the plan]
constexpr double kMostDrift = 0.1;    // as far as the referee lets a goal be missed [m]
constexpr double kMostTurn = 0.1;     // the same in rad
constexpr double kSpacing = 0.00025;  // of the moments [m on the desk]

/// The arc that joins two poses: by its chord, and half the change of heading.
Leg leg_between(const Pose& from, const Pose& to) {
  const double turn = wrap_to_pi(to.theta - from.theta);
  const double dx = to.x - from.x;
  const double dy = to.y - from.y;
  const double chord = dx * std::cos(from.theta + turn / 2) + dy * std::sin(from.theta + turn / 2);
  Leg leg{from, {0.0, 0.0}, {}};
  if (std::hypot(dx, dy) > kWait) {
    const double half = turn / 2;
    leg.arc.length = std::abs(half) < 1e-6 ? chord : chord * half / std::sin(half);
    leg.arc.curvature = leg.arc.length == 0.0 ? 0.0 : turn / leg.arc.length;
  }
  const Pose end = drive(from, leg.arc);
  leg.drift = {to.x - end.x, to.y - end.y, wrap_to_pi(to.theta - end.theta)};
  return leg;
}

int sign_of(double value) { return value > 0.0 ? 1 : (value < 0.0 ? -1 : 0); }

/// Legs [begin, end) driven in one direction without a stop, or one wait after the other.
struct Stretch {
  std::size_t begin = 0;
  std::size_t end = 0;
};

std::vector<Stretch> stretches_of(const std::vector<Leg>& legs) {
  std::vector<Stretch> stretches;
  for (std::size_t i = 0; i < legs.size(); ++i) {
    const bool goes_on = i > 0 && sign_of(legs[i].arc.length) == sign_of(legs[i - 1].arc.length);
    if (goes_on) {
      stretches.back().end = i + 1;
    } else {
      stretches.push_back({i, i + 1});
    }
  }
  return stretches;
}

/// One small piece of a stretch.
struct Piece {
  Pose end;
  double length = 0.0;
  double plan_end = 0.0;
  double speed_limit = 0.0;  ///< within the piece
};

double speed_limit(const Leg& leg, double dt, const Pace& pace) {
  const double planned = std::abs(leg.arc.length) / dt * pace.speedup;
  const double outer = 1.0 + std::abs(leg.arc.curvature) * pace.cube.track / 2.0;
  const double least = 1.06 * least_speed(pace.cube, leg.arc.curvature);
  return std::min(std::max(planned, least), pace.cube.top_speed() / outer);
}

std::vector<Piece> pieces_of(const std::vector<Leg>& legs, const Stretch& stretch, double dt,
                             const Pace& pace) {
  std::vector<Piece> pieces;
  for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
    const double length = std::abs(legs[i].arc.length);
    // At least two, so that the speed between them is not 0.
    const int count = std::max(2, int(std::ceil(length / kSpacing)));
    const double limit = speed_limit(legs[i], dt, pace);
    for (int k = 1; k <= count; ++k) {
      const double share = double(k) / count;
      pieces.push_back({legs[i].at(share), length / count, (double(i) + share) * dt, limit});
    }
  }
  return pieces;
}

/// Speeds at the ends of the pieces, from rest to rest: one pass forwards, one backwards.
std::vector<double> speeds_of(const std::vector<Piece>& pieces, double accel) {
  const std::size_t n = pieces.size();
  std::vector<double> speeds(n + 1, 0.0);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double reachable = std::sqrt(speeds[i] * speeds[i] + 2.0 * accel * pieces[i].length);
    speeds[i + 1] = std::min({reachable, pieces[i].speed_limit, pieces[i + 1].speed_limit});
  }
  for (std::size_t i = n; i-- > 0;) {
    const double able = std::sqrt(speeds[i + 1] * speeds[i + 1] + 2.0 * accel * pieces[i].length);
    speeds[i] = std::min(speeds[i], able);
  }
  return speeds;
}

}  // namespace

std::vector<Leg> legs_of(const Trajectory& trajectory, const std::string& where) {
  const std::vector<Waypoint>& waypoints = trajectory.waypoints();
  std::vector<Leg> legs;
  for (std::size_t t = 1; t < waypoints.size(); ++t) {
    const Leg leg = leg_between(waypoints[t - 1].pose, waypoints[t].pose);
    if (std::abs(leg.drift.theta) > kMostTurn) {
      throw InputError(fmt::format("{}[{}]", where, t),
                       fmt::format("turns by {:.2f} rad on the spot; wheels of a cube could, but a "
                                   "plan for cars should not: let mvtp validate judge it",
                                   leg.drift.theta));
    }
    if (std::hypot(leg.drift.x, leg.drift.y) > kMostDrift) {
      throw InputError(fmt::format("{}[{}]", where, t),
                       fmt::format("is {:.2f} m beside every arc from the step before; let mvtp "
                                   "validate judge the plan",
                                   std::hypot(leg.drift.x, leg.drift.y)));
    }
    legs.push_back(leg);
  }
  while (!legs.empty() && legs.back().arc.length == 0.0) legs.pop_back();
  return legs;
}

std::vector<Leg> to_desk(const PlanFrame& frame, const std::vector<Leg>& legs) {
  const Pose zero = frame.to_desk(Pose{});
  std::vector<Leg> result;
  for (const Leg& leg : legs) {
    const Pose drift = frame.to_desk(leg.drift);
    result.push_back({frame.to_desk(leg.from),
                      {leg.arc.length * frame.scale, leg.arc.curvature / frame.scale},
                      {drift.x - zero.x, drift.y - zero.y, leg.drift.theta}});
  }
  return result;
}

std::vector<MotionSample> retime(const std::vector<Leg>& legs, const Pose& start, double dt,
                                 const Pace& pace) {
  std::vector<MotionSample> samples = {{0.0, 0.0, start, 0, 0.0}};
  for (const Stretch& stretch : stretches_of(legs)) {
    const double plan_begin = double(stretch.begin) * dt;
    const int direction = sign_of(legs[stretch.begin].arc.length);
    double time = std::max(samples.back().time, plan_begin / pace.speedup);
    if (direction == 0) continue;  // the next stretch begins when the plan says, or later

    samples.push_back({time, plan_begin, samples.back().pose, direction, 0.0});
    const std::vector<Piece> pieces = pieces_of(legs, stretch, dt, pace);
    const std::vector<double> speeds = speeds_of(pieces, pace.accel);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      time += 2.0 * pieces[i].length / (speeds[i] + speeds[i + 1]);
      samples.push_back({time, pieces[i].plan_end, pieces[i].end, direction, speeds[i + 1]});
    }
    samples.push_back({time, pieces.back().plan_end, pieces.back().end, 0, 0.0});
  }
  return samples;
}

MotionSample at_time(const std::vector<MotionSample>& samples, double time) {
  const auto after = std::ranges::upper_bound(samples, time, {}, &MotionSample::time);
  if (after == samples.begin()) return samples.front();
  if (after == samples.end()) return samples.back();
  const MotionSample& a = *(after - 1);
  const MotionSample& b = *after;
  const double s = (time - a.time) / (b.time - a.time);  // share of the time, then of the path
  const double speeds = a.speed + b.speed;
  const double share = speeds > 0.0 ? s * (2.0 * a.speed + s * (b.speed - a.speed)) / speeds : s;
  const Pose pose{a.pose.x + share * (b.pose.x - a.pose.x),
                  a.pose.y + share * (b.pose.y - a.pose.y),
                  wrap_to_pi(a.pose.theta + share * wrap_to_pi(b.pose.theta - a.pose.theta))};
  return {time, a.plan_time + share * (b.plan_time - a.plan_time), pose, a.direction,
          a.speed + s * (b.speed - a.speed)};
}

double time_of(const std::vector<MotionSample>& samples, double plan_time) {
  const auto at = std::ranges::lower_bound(samples, plan_time, {}, &MotionSample::plan_time);
  if (at == samples.begin()) return samples.front().time;
  if (at == samples.end()) return samples.back().time;
  const MotionSample& a = *(at - 1);
  const MotionSample& b = *at;
  const double share = (plan_time - a.plan_time) / (b.plan_time - a.plan_time);
  const double speeds = a.speed + b.speed;
  if (speeds <= 0.0) return a.time + share * (b.time - a.time);
  const double speed =
      std::sqrt(a.speed * a.speed + share * (b.speed * b.speed - a.speed * a.speed));
  return a.time + share * (b.time - a.time) * speeds / (a.speed + speed);
}

}  // namespace mvtp
