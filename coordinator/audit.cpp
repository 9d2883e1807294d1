#include "coordinator/audit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace mvtp {
namespace {

using Corners = std::array<Point, 4>;

Corners corners(const Pose& rear_axle, const Vehicle& body) {
  const double half = body.width / 2.0;
  Corners result;
  const std::array<Point, 4> local = {
      {{body.front, half}, {-body.rear, half}, {-body.rear, -half}, {body.front, -half}}};
  for (std::size_t i = 0; i < 4; ++i) {
    const Pose p = compose(rear_axle, {local[i].x, local[i].y, 0.0});
    result[i] = {p.x, p.y};
  }
  return result;
}

/// How far all corners of `b` lie beyond the best side of `a` [m]; negative: none separates them.
double separation(const Corners& a, const Corners& b) {
  double best = -1e300;
  for (std::size_t i = 0; i < 4; ++i) {
    const Point& p = a[i];
    const Point& q = a[(i + 1) % 4];
    const double length = std::hypot(q.x - p.x, q.y - p.y);
    const Point outward{(q.y - p.y) / length, -(q.x - p.x) / length};
    double nearest = 1e300;
    for (const Point& c : b) {
      nearest = std::min(nearest, (c.x - p.x) * outward.x + (c.y - p.y) * outward.y);
    }
    // Corners run front left, rear left, rear right, front right: counter-clockwise.
    best = std::max(best, nearest);
  }
  return best;
}

double distance_to_side(const Point& p, const Point& a, const Point& b) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double f =
      std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return std::hypot(p.x - a.x - f * dx, p.y - a.y - f * dy);
}

/// Two disjoint rectangles are nearest at a corner of one of them.
double corner_distance(const Corners& a, const Corners& b) {
  double nearest = 1e300;
  for (const Point& p : a) {
    for (std::size_t i = 0; i < 4; ++i) {
      nearest = std::min(nearest, distance_to_side(p, b[i], b[(i + 1) % 4]));
    }
  }
  return nearest;
}

/// The arc over a chord: at speed in a bend the chord is shorter by enough to look like braking.
double arc_length(double chord, double turned) {
  const double half = 0.5 * turned;
  return half > 1e-6 ? chord * half / std::sin(half) : chord;
}

Point front_bumper(const Pose& rear_axle, const Vehicle& body) {
  const Pose p = compose(rear_axle, {body.front, 0.0, 0.0});
  return {p.x, p.y};
}

}  // namespace

double clearance(const Pose& a, const Vehicle& body_a, const Pose& b, const Vehicle& body_b) {
  const Corners ca = corners(a, body_a);
  const Corners cb = corners(b, body_b);
  const double gap = std::max(separation(ca, cb), separation(cb, ca));
  if (gap <= 0.0) return gap;
  return std::min(corner_distance(ca, cb), corner_distance(cb, ca));
}

void Audit::observe(double time, std::span<const Sighting> sightings,
                    std::span<const Pedestrian> people) {
  compare_pairs(time, sightings);
  compare_with_people(time, sightings, people);
  for (const Sighting& s : sightings) follow(time, s);
  std::erase_if(tracks_, [&](const auto& track) {
    const auto seen = std::ranges::lower_bound(sightings, track.first, {},
                                               [](const Sighting& s) { return s.state->id; });
    return seen == sightings.end() || seen->state->id != track.first;
  });
}

void Audit::compare_with_people(double time, std::span<const Sighting> sightings,
                                std::span<const Pedestrian> people) {
  for (const Sighting& s : sightings) {
    if (!s.coordinated) continue;
    const Vehicle& body = s.type->body;
    for (const Pedestrian& person : people) {
      const Pose p = relative(s.state->pose, {person.position.x, person.position.y, 0.0});
      const double ahead = std::max({p.x - body.front, -body.rear - p.x, 0.0});
      const double aside = std::max(std::abs(p.y) - body.width / 2.0, 0.0);
      const double gap = std::hypot(ahead, aside) - person.radius;
      figures_.min_person_clearance = std::min(figures_.min_person_clearance, gap);
      if (gap >= -kTolerance || !touched_people_.insert({s.state->id, person.id}).second) continue;
      events_.push_back({time, s.state->id + " touches " + person.id, person.position});
    }
  }
  figures_.people_touched = std::int64_t(touched_people_.size());
}

void Audit::compare_pairs(double time, std::span<const Sighting> sightings) {
  constexpr double kNear = 3.0;  // [m]: larger clearances are nobody's minimum
  std::vector<std::size_t> by_x(sightings.size());
  for (std::size_t i = 0; i < by_x.size(); ++i) by_x[i] = i;
  const auto reach = [&](std::size_t i) {
    const Vehicle& body = sightings[i].type->body;
    return std::hypot(std::max(body.front, body.rear), body.width / 2.0);
  };
  const auto x_of = [&](std::size_t i) { return sightings[i].state->pose.x; };
  std::ranges::sort(by_x, {}, x_of);
  double widest = 0.0;
  for (const std::size_t i : by_x) widest = std::max(widest, reach(i));

  latest_clearance_.reset();
  std::set<std::size_t> touching;
  for (std::size_t n = 0; n < by_x.size(); ++n) {
    const std::size_t i = by_x[n];
    for (std::size_t m = n + 1; m < by_x.size(); ++m) {
      const std::size_t j = by_x[m];
      if (x_of(j) - x_of(i) > reach(i) + widest + kNear) break;
      const Sighting& a = sightings[i];
      const Sighting& b = sightings[j];
      if (distance(a.state->pose, b.state->pose) > reach(i) + reach(j) + kNear) continue;
      const double gap = clearance(a.state->pose, a.type->body, b.state->pose, b.type->body);
      if (gap >= kNear) continue;
      figures_.min_clearance = std::min(figures_.min_clearance, gap);
      latest_clearance_ = std::min(latest_clearance_.value_or(kNear), gap);
      for (const Sighting* s : {&a, &b}) {
        double& least = clearances_.try_emplace(s->state->id, kNear).first->second;
        least = std::min(least, gap);
      }
      if (gap >= -kTolerance) continue;
      touching.insert({i, j});
      const auto pair = std::minmax(a.state->id, b.state->id);
      if (overlapping_.insert(pair).second) {
        events_.push_back({time,
                           "overlap of " + pair.first + " and " + pair.second,
                           {a.state->pose.x, a.state->pose.y}});
      }
      if (a.coordinated || b.coordinated) overlapping_coordinated_.insert(pair);
    }
  }
  figures_.overlap_vehicle_steps += std::int64_t(touching.size());
  figures_.overlap_pairs = std::int64_t(overlapping_.size());
  figures_.overlap_pairs_coordinated = std::int64_t(overlapping_coordinated_.size());
}

void Audit::follow(double time, const Sighting& s) {
  if (area_.share_outside(s.state->pose, s.type->body, kRoadTolerance) > 0.0) {
    ++figures_.off_road_steps;
    figures_.off_road_steps_coordinated += s.coordinated ? 1 : 0;
    if (events_.size() < 1000) {
      events_.push_back(
          {time, s.state->id + " is off the road", {s.state->pose.x, s.state->pose.y}});
    }
  }
  Track now{.pose = s.state->pose,
            .front = front_bumper(s.state->pose, s.type->body),
            .speed = s.state->speed,
            .coordinated = s.coordinated};
  const auto found = tracks_.find(s.state->id);
  if (found != tracks_.end()) {
    const Track& before = found->second;
    now.handed_back = before.coordinated && !s.coordinated ? time : before.handed_back;
    if (before.coordinated != s.coordinated) {
      figures_.max_jump = std::max(figures_.max_jump, jump(before, now));
    }
    if (s.coordinated) judge_motion(time, s, before, now);
    const double braking = (before.speed - now.speed) / dt_;
    if (!s.coordinated && time - now.handed_back < kAfterHandback &&
        braking > s.type->body.max_decel + 0.1) {
      ++figures_.hard_brakings_after_handback;
      events_.push_back({time,
                         s.state->id + " brakes hard after its hand-back",
                         {s.state->pose.x, s.state->pose.y}});
    }
  }
  tracks_.insert_or_assign(s.state->id, now);
}

void Audit::judge_motion(double time, const Sighting& s, const Track& before, Track& now) {
  const Vehicle& body = s.type->body;
  const double turned = std::abs(wrap_to_pi(now.pose.theta - before.pose.theta));
  const double driven = arc_length(distance(before.pose, now.pose), turned);
  now.driven_speed = driven / dt_;
  figures_.max_speed = std::max(figures_.max_speed, now.driven_speed);
  if (driven > 0.05) {
    figures_.max_curvature_ratio =
        std::max(figures_.max_curvature_ratio, turned / driven * body.min_turning_radius);
  }
  figures_.max_lateral_accel =
      std::max(figures_.max_lateral_accel, turned / dt_ * now.driven_speed);
  if (before.driven_speed < 0.0) return;  // the step of the takeover has no speed to compare with
  const double accel = (now.driven_speed - before.driven_speed) / dt_;
  figures_.max_accel = std::max(figures_.max_accel, accel);
  figures_.max_decel = std::max(figures_.max_decel, -accel);
  constexpr double kNoise = 0.05;  // [m/s^2] from differentiating positions twice
  if (accel > body.max_accel + kNoise || -accel > body.max_decel + kNoise) {
    ++figures_.accel_violations;
    events_.push_back(
        {time, s.state->id + " exceeds its acceleration", {now.front.x, now.front.y}});
  }
}

double Audit::jump(const Track& before, const Track& now) const {
  const double heading = before.pose.theta + 0.5 * wrap_to_pi(now.pose.theta - before.pose.theta);
  const double dx = now.front.x - before.front.x;
  const double dy = now.front.y - before.front.y;
  const double along = dx * std::cos(heading) + dy * std::sin(heading);
  const double aside = -dx * std::sin(heading) + dy * std::cos(heading);
  const auto [slow, fast] = std::minmax(before.speed, now.speed);
  const double excess = std::max({0.0, along - fast * dt_, slow * dt_ - along});
  return std::hypot(excess, aside);
}

}  // namespace mvtp
