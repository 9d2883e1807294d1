#include "coordinator/audit/audit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mvtp {
namespace {

constexpr double kNear = 3.0;  // [m]: larger clearances are nobody's minimum

/// The displacement between two poses, seen along the heading half way between them.
struct Displacement {
  double along = 0.0;   ///< [m], of every point on the axis of the body
  double aside = 0.0;   ///< [m], of the rear axle, to the left
  double turned = 0.0;  ///< [rad]
};

Displacement displacement(const Pose& before, const Pose& now) {
  const double turned = wrap_to_pi(now.theta - before.theta);
  const Pose d = relative({before.x, before.y, before.theta + 0.5 * turned}, now);
  return {d.x, d.y, turned};
}

/// The arc over a chord: at speed in a bend the chord is shorter by enough to look like braking.
double arc_length(double chord, double turned) {
  const double half = 0.5 * std::abs(turned);
  return half > 1e-6 ? chord * half / std::sin(half) : chord;
}

/// How far the rear axle went between two poses [m]; negative in reverse.
double driven(const Displacement& d) {
  return std::copysign(arc_length(std::hypot(d.along, d.aside), d.turned), d.along);
}

double reach(const Vehicle& body) {
  return std::hypot(std::max(body.front, body.rear), body.width / 2.0);
}

}  // namespace

Audit::Audit(const DrivableArea& area, double step_length, const RoadNetwork& network,
             std::span<const ParkingLot> lots)
    : area_(area), dt_(step_length), network_(&network), lots_(lots) {}

void Audit::observe(double time, std::span<const Observation> observations,
                    std::span<const Pedestrian> people) {
  const std::vector<Passage> moved = passages(observations);
  compare_pairs(time, moved);
  compare_with_people(time, moved, people);
  for (const Observation& s : observations) follow(time, s);
  std::erase_if(tracks_, [&](const auto& track) {
    const auto seen = std::ranges::lower_bound(observations, track.first, {},
                                               [](const Observation& s) { return s.state->id; });
    return seen == observations.end() || seen->state->id != track.first;
  });
  people_.clear();
  for (const Pedestrian& person : people) people_.emplace(person.id, person.position);
}

std::vector<Audit::Passage> Audit::passages(std::span<const Observation> observations) const {
  std::vector<Passage> result;
  for (const Observation& s : observations) {
    const auto found = tracks_.find(s.state->id);
    const bool moves = found != tracks_.end() && !leaps(s, found->second);
    const Pose& from = moves ? found->second.pose : s.state->pose;
    const StepMotion motion(from, s.state->pose);
    const Point motion_of_step = motion.velocity(0.0);
    result.push_back(
        {.seen = &s,
         .motion = motion,
         .from = moves ? 0.0 : 1.0,
         .middle = motion.at(0.5),
         .reach = reach(s.type->body) + 0.5 * std::hypot(motion_of_step.x, motion_of_step.y)});
  }
  return result;
}

bool Audit::leaps(const Observation& now, const Track& before) const {
  if (now.coordinated) return false;
  const Displacement d = displacement(before.pose, now.state->pose);
  const double fast = std::max(before.speed, now.state->speed);
  return std::abs(d.aside) > kLeap || d.along > fast * dt_ + kLeap || d.along < -kLeap;
}

void Audit::compare_with_people(double time, std::span<const Passage> passages,
                                std::span<const Pedestrian> people) {
  for (const Pedestrian& person : people) {
    const auto found = people_.find(person.id);
    const Point before = found == people_.end() ? person.position : found->second;
    const double walked = std::hypot(person.position.x - before.x, person.position.y - before.y);
    // Who appears or is put elsewhere did not walk there.
    const bool walks = found != people_.end() && walked <= person.speed * dt_ + kLeap;
    for (const Passage& p : passages) {
      compare_with_person(time, p, person, walks, walks ? before : person.position);
    }
  }
  figures_.people_touched_all = std::int64_t(touched_people_.size());
  figures_.people_touched =
      std::ranges::count_if(touched_people_, [](const auto& entry) { return entry.second; });
}

/// @param before  where the person was, if he walked from there.
void Audit::compare_with_person(double time, const Passage& p, const Pedestrian& person, bool walks,
                                const Point& before) {
  const bool ours = p.seen->coordinated;
  const double walked = std::hypot(person.position.x - before.x, person.position.y - before.y);
  const double apart = std::hypot(p.middle.x - person.position.x, p.middle.y - person.position.y);
  // Whatever is further is neither a contact nor the smallest clearance.
  const double least = std::max(0.0, ours ? figures_.min_person_clearance : 0.0);
  if (apart - p.reach - person.radius - walked >= least) return;
  const Vehicle& body = p.seen->type->body;
  const double from = walks ? p.from : 1.0;
  double gap = deepest_moment(p.motion, body, before, person, from).gap;
  if (gap >= 0.0 && ours) {
    const double enough = std::min(least, 1e6);
    gap = std::max(0.0, nearest_moment(p.motion, body, before, person, from, enough).gap);
  }
  if (ours) figures_.min_person_clearance = std::min(figures_.min_person_clearance, gap);
  if (gap >= -kTolerance) return;
  const std::string& id = p.seen->state->id;
  const auto [touched, is_new] = touched_people_.try_emplace({id, person.id}, ours);
  if (is_new || (ours && !touched->second)) {
    events_.push_back({AuditEventKind::kPersonTouched,
                       time,
                       id + " touches " + person.id,
                       person.position,
                       {id, person.id},
                       -gap});
  }
  touched->second |= ours;
}

void Audit::compare_pairs(double time, std::span<const Passage> passages) {
  std::vector<std::size_t> by_west(passages.size());
  for (std::size_t i = 0; i < by_west.size(); ++i) by_west[i] = i;
  const auto west = [&](std::size_t i) { return passages[i].middle.x - passages[i].reach; };
  std::ranges::sort(by_west, {}, west);

  latest_clearance_.reset();
  std::set<std::size_t> touching;
  for (std::size_t n = 0; n < by_west.size(); ++n) {
    const Passage& a = passages[by_west[n]];
    for (std::size_t m = n + 1; m < by_west.size(); ++m) {
      const Passage& b = passages[by_west[m]];
      if (west(by_west[m]) > a.middle.x + a.reach + kNear) break;
      if (distance(a.middle, b.middle) > a.reach + b.reach + kNear) continue;
      if (compare(time, a, b)) touching.insert({by_west[n], by_west[m]});
    }
  }
  figures_.overlap_vehicle_steps += std::int64_t(touching.size());
  figures_.overlap_pairs = std::int64_t(overlapping_.size());
  figures_.overlap_pairs_coordinated = std::int64_t(overlapping_coordinated_.size());
}

bool Audit::compare(double time, const Passage& a, const Passage& b) {
  const Vehicle& body_a = a.seen->type->body;
  const Vehicle& body_b = b.seen->type->body;
  const double from = std::max(a.from, b.from);
  const NearestMoment deepest = deepest_moment(a.motion, body_a, b.motion, body_b, from);
  double gap = deepest.gap;
  if (gap >= 0.0) {
    gap = std::max(0.0, nearest_moment(a.motion, body_a, b.motion, body_b, from, kNear).gap);
  }
  if (gap >= kNear) return false;
  figures_.min_clearance = std::min(figures_.min_clearance, gap);
  latest_clearance_ = std::min(latest_clearance_.value_or(kNear), gap);
  for (const Passage* p : {&a, &b}) {
    double& least = clearances_.try_emplace(p->seen->state->id, kNear).first->second;
    least = std::min(least, gap);
  }
  if (gap >= -kTolerance) return false;
  const auto pair = std::minmax(a.seen->state->id, b.seen->state->id);
  const bool is_ours = a.seen->coordinated || b.seen->coordinated;
  const bool is_new = overlapping_.insert(pair).second;
  if ((is_ours && overlapping_coordinated_.insert(pair).second) || is_new) {
    report_overlap(time - (1.0 - deepest.t) * dt_, a, b, a.motion.at(deepest.t), -gap);
  }
  return true;
}

void Audit::report_overlap(double time, const Passage& a, const Passage& b, const Pose& where,
                           double depth) {
  const auto [first, second] = std::minmax(
      *a.seen, *b.seen,
      [](const Observation& x, const Observation& y) { return x.state->id < y.state->id; });
  const auto name_of = [](const Observation& seen) {
    return seen.state->id + (seen.coordinated ? "" : " (human-driven)");
  };
  events_.push_back({AuditEventKind::kOverlap,
                     time,
                     "overlap of " + name_of(first) + " and " + name_of(second),
                     {where.x, where.y},
                     {first.state->id, second.state->id},
                     depth,
                     first.coordinated || second.coordinated});
}

void Audit::report(AuditEventKind kind, double time, const Observation& s,
                   const std::string& what) {
  const VehicleState& v = *s.state;
  events_.push_back({kind, time, v.id + ' ' + what, {v.pose.x, v.pose.y}, {v.id}});
}

/// Where vehicles of this class may be.
const DrivableArea& Audit::ground_of(const std::string& vehicle_class) {
  if (network_ == nullptr) return area_;
  const auto [ground, is_new] = grounds_.try_emplace(vehicle_class);
  if (is_new) {
    const bool has_own_lanes = std::ranges::any_of(network_->lanes, [&](const auto& entry) {
      return !entry.second.road && entry.second.allows(vehicle_class);
    });
    if (has_own_lanes) {
      ground->second.emplace(*network_, lots_, vehicle_class, never_interrupted);
    }
  }
  return ground->second ? *ground->second : area_;
}

void Audit::follow(double time, const Observation& s) {
  Track now{.pose = s.state->pose,
            .speed = s.state->speed,
            .along = {},
            .recent = {},
            .coordinated = s.coordinated,
            .off_road = ground_of(s.type->vehicle_class)
                            .share_outside(s.state->pose, s.type->body, kRoadTolerance) > 0.0,
            .handed_back = -1e9};
  const auto found = tracks_.find(s.state->id);
  if (now.off_road) {
    ++figures_.off_road_steps;
    figures_.off_road_steps_coordinated += s.coordinated ? 1 : 0;
    // Once for each time that it leaves the road, or comes under control beside it.
    const bool was = found != tracks_.end() && found->second.off_road &&
                     found->second.coordinated == s.coordinated;
    if (!was) {
      report(AuditEventKind::kOffRoad, time, s,
             s.coordinated ? "is off the road" : "(human-driven) is off the road");
    }
  }
  if (found != tracks_.end()) {
    const Track& before = found->second;
    now.handed_back = before.coordinated && !s.coordinated ? time : before.handed_back;
    now.along = std::abs(displacement(before.pose, now.pose).along);
    if (before.coordinated || s.coordinated) {
      const double jumped = jump(before, now, s.type->body);
      figures_.max_jump = std::max(figures_.max_jump, jumped);
      if (jumped > kJump) {
        report(AuditEventKind::kJump, time, s,
               fmt::format("jumps {:.2f} m at its {}", jumped,
                           s.coordinated ? "takeover" : "hand-back"));
      }
    }
    if (s.coordinated) judge_motion(time, s, before, now);
    const double braking = (before.speed - now.speed) / dt_;
    if (!s.coordinated && time - now.handed_back < kAfterHandback &&
        braking > s.type->body.max_decel + 0.1) {
      ++figures_.hard_brakings_after_handback;
      report(AuditEventKind::kHardBraking, time, s, "brakes hard after its hand-back");
    }
  }
  tracks_.insert_or_assign(s.state->id, std::move(now));
}

void Audit::judge_motion(double time, const Observation& s, const Track& before, Track& now) {
  const Displacement d = displacement(before.pose, now.pose);
  const Stretch latest{driven(d), d.turned};
  const double driven_speed = std::abs(latest.driven) / dt_;
  figures_.max_speed = std::max(figures_.max_speed, driven_speed);
  if (std::abs(latest.driven) > 0.05) {
    figures_.max_curvature_ratio =
        std::max(figures_.max_curvature_ratio,
                 std::abs(latest.turned / latest.driven) * s.type->body.min_turning_radius);
  }
  if (!before.recent.empty()) {  // else the step of the takeover: no speed to compare with
    judge_acceleration(time, s, before.recent.back().driven / dt_, latest.driven / dt_);
    if (before.recent.back().driven * latest.driven >= 0.0) now.recent = before.recent;
  }
  now.recent.push_back(latest);
  // A metre evens out a heading that is off for one slow step, and leaves one at speed as it is.
  double length = 0.0;
  double turned = 0.0;
  std::size_t first = now.recent.size();
  while (first > 0 && std::abs(length) < 1.0 &&
         double(now.recent.size() - first) * dt_ < 1.0 - 1e-9) {
    --first;
    length += now.recent[first].driven;
    turned += now.recent[first].turned;
  }
  now.recent.erase(now.recent.begin(), now.recent.begin() + std::ptrdiff_t(first));
  const double span = double(now.recent.size()) * dt_;
  figures_.max_lateral_accel =
      std::max(figures_.max_lateral_accel, std::abs(turned) / span * std::abs(length) / span);
}

void Audit::judge_acceleration(double time, const Observation& s, double before, double now) {
  const Vehicle& body = s.type->body;
  const double change = (std::abs(now) - std::abs(before)) / dt_;
  double accel = std::max(change, 0.0);
  double decel = std::max(-change, 0.0);
  if (before * now < 0.0) {
    // It came to rest on the way: what is left of the step after the hardest braking allowed is
    // there to speed up the other way.
    const double left = dt_ - std::abs(before) / body.max_decel;
    decel = std::abs(left > 0.0 ? before : now - before) / dt_;
    accel = left > 0.0 ? std::abs(now) / left : 0.0;
  }
  figures_.max_accel = std::max(figures_.max_accel, accel);
  figures_.max_decel = std::max(figures_.max_decel, decel);
  constexpr double kNoise = 0.05;  // [m/s^2] from differentiating positions twice
  if (accel > body.max_accel + kNoise || decel > body.max_decel + kNoise) {
    ++figures_.accel_violations;
    report(AuditEventKind::kAcceleration, time, s, "exceeds its acceleration");
  }
}

double Audit::jump(const Track& before, const Track& now, const Vehicle& body) const {
  const Displacement d = displacement(before.pose, now.pose);
  // A body that follows a bend turns about some point of its axis, which does not move sideways.
  const double front = d.aside + body.front * d.turned;
  const double rear = d.aside - body.rear * d.turned;
  const double aside = front * rear <= 0.0 ? 0.0 : std::min(std::abs(front), std::abs(rear));
  const double farthest = std::hypot(d.along, std::max(std::abs(front), std::abs(rear)));
  const double turned = std::abs(d.turned) - std::hypot(d.along, aside) / body.min_turning_radius;
  const double swung = std::max(0.0, turned) * std::max(body.front, body.rear);
  if (before.coordinated && now.coordinated) return aside + swung;
  const auto [slow, fast] = std::minmax(before.speed, now.speed);
  double excess = std::max({0.0, std::abs(d.along) - fast * dt_, slow * dt_ - farthest});
  if (before.along) {
    // On a lane whose length is not that of its shape, a vehicle is not as fast as it says.
    const double more = body.max_accel * dt_ * dt_;
    const double less = body.max_decel * dt_ * dt_;
    excess = std::min(excess, std::max({0.0, std::abs(d.along) - *before.along - more,
                                        *before.along - less - farthest}));
  }
  return std::hypot(excess, aside + swung);
}

}  // namespace mvtp
