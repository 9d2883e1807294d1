#include "coordinator/drivers/gate.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "planner/motion/inertial_car.hpp"

namespace mvtp {
namespace {

constexpr double kNear = 12.0;     ///< [m] before its line a vehicle waits for its turn,
constexpr double kCrawl = 5.0;     ///< [m/s] at no more than this;
constexpr double kStands = 0.5;    ///< [m/s] or it stands where it was held
constexpr double kInside = 5.0;    ///< [m] before the end of its lane: it is as good as inside
constexpr double kApart = 50.0;    ///< [m] to the next line: there it is held again
constexpr double kReaction = 0.5;  ///< [s] until a driver who is to stop brakes
constexpr int kStuckAfter = 4;     ///< decisions for which one that was let through may stand:
                                   ///< then it is held again, and waits for its next turn
constexpr double kClear = 30.0;    ///< [m] between guests on different lanes who pass at a time

}  // namespace

void Gate::begin() {
  ++decisions_;
  for (auto& [id, visitor] : visitors_) visitor.seen = false;
}

void Gate::see(const VehicleState& v, const Place& place, const Vehicle& body) {
  Visitor& guest = visitors_[v.id];
  const bool came = !guest.guest;
  if (came) guest.asked = decisions_;
  guest.guest = true;
  guest.seen = true;
  guest.pose = v.pose;
  if (!guest.passes) guest.lane = v.lane;
  guest.stands = v.speed < kStands ? guest.stands + 1 : 0;
  const bool crawls = place.to_line < kNear && v.speed < kCrawl;
  guest.waits = place.leads_on && place.is_first && (crawls || v.speed < kStands);
  const double room = stopping_distance(v.speed, 0.8 * body.max_decel) + kReaction * v.speed;
  const bool anew = guest.passes && place.to_line > std::max(kApart, room);
  // It stands before its line although it may go: somebody blocking its path may be waiting for it.
  const bool in_vain = guest.passes && guest.stands >= kStuckAfter && place.to_hold > 0.0;
  if (in_vain) guest.asked = decisions_;
  if (!guest.held && (came || anew || in_vain)) {
    if (place.to_hold > room) {
      hold(v.id);
    } else {
      let_through(v.id);
    }
  }
  guest.enters = place.leads_on && place.to_hold <= kInside;
  keep_in_lane(v.id, guest);
}

/// Drivers of SUMO change lanes at their lines and inside junctions, too, onto ground that is not
/// theirs. Who has to, may.
void Gate::keep_in_lane(const std::string& id, const Visitor& guest) {
  keeping_.keep(id, LaneKeeping::Reason::kGuest, guest.passes && guest.enters);
}

void Gate::keep(const std::string& id) {
  const auto visitor = visitors_.find(id);
  if (visitor == visitors_.end()) return;
  visitor->second.seen = true;
  visitor->second.guest = false;
}

void Gate::end() {
  std::vector<std::string> left;
  for (const auto& [id, visitor] : visitors_) {
    if (!visitor.seen) left.push_back(id);
  }
  for (const std::string& id : left) release(id);
}

void Gate::hold(const std::string& id) {
  Visitor& visitor = visitors_[id];
  visitor.seen = true;
  if (visitor.held) return;
  if (visitor.passes) traffic_.let_through(id, Passage::kNone);
  visitor.passes = false;
  visitor.held = true;
  traffic_.hold(id, true);
}

bool Gate::passes(const std::string& id) const {
  const auto visitor = visitors_.find(id);
  return visitor != visitors_.end() && visitor->second.passes;
}

bool Gate::holds_guest(const std::string& id) const {
  const auto visitor = visitors_.find(id);
  return visitor != visitors_.end() && visitor->second.guest && visitor->second.held;
}

/// Drivers on one lane keep clear of each other.
bool Gate::are_apart(const Visitor& a, const Visitor& b) {
  return a.lane == b.lane || std::hypot(a.pose.x - b.pose.x, a.pose.y - b.pose.y) > kClear;
}

std::vector<std::string> Gate::propose() {
  std::vector<std::pair<std::int64_t, std::string>> waiting;
  std::vector<const Visitor*> passing;
  for (const auto& [id, visitor] : visitors_) {
    if (visitor.guest && visitor.held && visitor.waits) waiting.emplace_back(visitor.asked, id);
    if (visitor.passes && visitor.stands < kStuckAfter) passing.push_back(&visitor);
  }
  std::ranges::sort(waiting);
  std::vector<std::string> proposed;
  for (const auto& [asked, id] : waiting) {
    Visitor& visitor = visitors_.at(id);
    if (!std::ranges::all_of(passing, [&](const Visitor* p) { return are_apart(visitor, *p); })) {
      continue;
    }
    visitor.asked = decisions_;
    passing.push_back(&visitor);
    proposed.push_back(id);
  }
  return proposed;
}

void Gate::let_through(const std::string& id) {
  Visitor& visitor = visitors_.at(id);
  if (visitor.held) traffic_.hold(id, false);
  traffic_.let_through(id, passage_);
  visitor.held = false;
  visitor.passes = true;
  visitor.stands = 0;
  keep_in_lane(id, visitor);
}

void Gate::release(const std::string& id) {
  const auto visitor = visitors_.find(id);
  if (visitor == visitors_.end()) return;
  if (visitor->second.held) traffic_.hold(id, false);
  if (visitor->second.passes) traffic_.let_through(id, Passage::kNone);
  keeping_.keep(id, LaneKeeping::Reason::kGuest, false);
  visitors_.erase(visitor);
}

void Gate::release_all() {
  while (!visitors_.empty()) release(std::string(visitors_.begin()->first));
}

}  // namespace mvtp
