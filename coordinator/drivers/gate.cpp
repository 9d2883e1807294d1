#include "coordinator/drivers/gate.hpp"

#include <algorithm>
#include <vector>

#include "planner/motion/inertial_car.hpp"

namespace mvtp {
namespace {

constexpr double kNear = 12.0;     ///< [m] before its line a vehicle waits for its turn,
constexpr double kEarly = 2.0;     ///< [s] or so long before its driver has to brake,
constexpr double kStands = 0.5;    ///< [m/s] or it stands where it was held
constexpr double kBack = 1.0;      ///< [m] that no driver goes back
constexpr double kInside = 5.0;    ///< [m] before the end of its lane: it is as good as inside
constexpr double kReaction = 0.5;  ///< [s] until a driver who is to stop brakes
constexpr int kStuckAfter = 4;     ///< decisions for which one that was let through may stand:
                                   ///< then it is held again, and waits for its next turn

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
  guest.stands = v.speed < kStands ? guest.stands + 1 : 0;
  const double room = stopping_distance(v.speed, 0.8 * body.max_decel) + kReaction * v.speed;
  const bool is_due = place.to_hold < std::max(kNear, room + kEarly * v.speed);
  guest.waits = place.leads_on && place.is_first && (is_due || v.speed < kStands);
  // Behind its line; the next one is ahead.
  guest.is_over |= place.to_line > guest.to_line + kBack;
  guest.to_line = place.to_line;
  const bool anew = guest.passes && guest.is_over && place.has_room && place.to_hold > room;
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
  guest.leads_on = place.leads_on;
  guest.enters = place.to_hold <= kInside;
  keep_in_lane(v.id, guest);
}

/// Drivers of SUMO change lanes at their lines and inside junctions, too, onto ground that is not
/// theirs: a passage is planned in one lane, from when he is let through. Who has to change, may.
void Gate::keep_in_lane(const std::string& id, const Visitor& guest) {
  keeping_.keep(id, LaneKeeping::Reason::kGuest,
                guest.passes && guest.leads_on && (guest.enters || !guest.is_over));
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
  visitor.passes = visitor.is_over = false;
  visitor.held = true;
  traffic_.hold(id, true);
}

bool Gate::holds(const std::string& id) const {
  const auto visitor = visitors_.find(id);
  return visitor != visitors_.end() && visitor->second.held;
}

bool Gate::passes(const std::string& id) const {
  const auto visitor = visitors_.find(id);
  return visitor != visitors_.end() && visitor->second.passes;
}

bool Gate::holds_guest(const std::string& id) const {
  const auto visitor = visitors_.find(id);
  return visitor != visitors_.end() && visitor->second.guest && visitor->second.held;
}

bool Gate::is_under_way(const std::string& id) const {
  const auto visitor = visitors_.find(id);
  return visitor != visitors_.end() && visitor->second.guest && visitor->second.stands == 0;
}

std::vector<std::string> Gate::propose(const MayMeet& may_meet) {
  std::vector<std::pair<std::int64_t, std::string>> waiting;
  std::vector<std::string> passing;
  for (const auto& [id, visitor] : visitors_) {
    if (visitor.guest && visitor.held && visitor.waits) waiting.emplace_back(visitor.asked, id);
    if (visitor.passes && visitor.stands < kStuckAfter) passing.push_back(id);
  }
  std::ranges::sort(waiting);
  std::vector<std::string> proposed;
  for (const auto& [asked, id] : waiting) {
    if (std::ranges::any_of(passing, [&](const auto& other) { return may_meet(id, other); })) {
      continue;
    }
    visitors_.at(id).asked = decisions_;
    passing.push_back(id);
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
