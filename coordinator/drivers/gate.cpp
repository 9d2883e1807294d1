#include "coordinator/drivers/gate.hpp"

#include <algorithm>
#include <vector>

#include "planner/road.hpp"

namespace mvtp {
namespace {

constexpr double kNear = 12.0;     ///< [m] before its line a vehicle waits for its turn,
constexpr double kEarly = 2.0;     ///< [s] or so long before its driver has to brake,
constexpr double kStands = 0.5;    ///< [m/s] or it stands where it was held
constexpr double kInside = 5.0;    ///< [m] before the end of its lane: it is as good as inside
constexpr double kReaction = 0.5;  ///< [s] until a driver who is to stop brakes
constexpr double kAtEnd = 1.5;     ///< [m] before the end of a lane that does not lead on
constexpr int kStuckAfter = 4;     ///< decisions for which one that was let through may stand:
                                   ///< then it is held again, and waits for its next turn
constexpr int kDueAfter = 40;      ///< decisions for which others may go before the first on a lane
constexpr int kDueBetween = 8;     ///< likewise between two lines, where he blocks others

}  // namespace

void Gate::begin() {
  ++decisions_;
  for (auto& [id, visitor] : visitors_) visitor.seen = false;
}

void Gate::see(const VehicleState& v, const Place& place, const Vehicle& body) {
  Visitor& guest = visitors_[v.id];
  if (!guest.guest) {
    guest.asked = decisions_;
    guest.line = place.line;
  }
  guest.guest = guest.seen = true;
  guest.place = place;
  if (place.to_hold >= 0.0) guest.lane = v.lane;
  guest.stands = v.speed < kStands ? guest.stands + 1 : 0;
  guest.is_over |= place.line != guest.line;
  const double room = stopping_distance(v.speed, 0.8 * body.max_decel) + kReaction * v.speed;
  const bool is_due = place.to_hold < std::max(kNear, room + kEarly * v.speed);
  guest.waits = place.leads_on && (is_due || v.speed < kStands);
  guest.can_stop = place.to_hold >= room;
  decide(v.id, guest, room);
  keep_in_lane(v.id, guest);
}

/// Holds it, or lets it through.
/// @param room  [m] that its driver needs to stop.
void Gate::decide(const std::string& id, Visitor& guest, double room) {
  const Place& place = guest.place;
  // Behind the line for which it was let through; the next one is ahead.
  const bool is_next = guest.passes && guest.is_over && place.has_room && guest.can_stop;
  // Plans lead over both junctions, and count on its doing so, too. Held in a lane that does not
  // lead on, it would not get out of it beside others who wait; at its end it has to stop anyway.
  guest.goes_on = is_next && place.is_between && place.leads_on;
  const bool at_end = !place.leads_on && guest.stands > 0 && place.to_hold < kAtEnd;
  const bool anew = is_next && (!place.is_between || at_end);
  // It stands before its line although it may go: somebody blocking its path may be waiting for it.
  const bool in_vain = guest.passes && guest.stands >= kStuckAfter && place.to_hold >= 0.0;
  if (in_vain) guest.asked = decisions_;
  const bool did_not_stop = guest.held && guest.is_over && (place.is_inside || guest.can_stop);
  if (did_not_stop) {
    traffic_.hold(id, false);
    guest.held = false;
  }
  if (guest.held || (guest.passes && !anew && !in_vain)) return;
  if (guest.can_stop) {
    hold(id);
  } else if (place.is_inside || place.to_line <= room) {
    let_through(id);
  }  // else it is held on a later lane
}

/// Drivers of SUMO change lanes at their lines and inside junctions, too, and with their tails
/// there, onto ground that is not theirs: a passage is planned in one lane, from when he is let
/// through. Who has to change, may as long as he could be held on the other lane, too: else he
/// would go on from there over a line for which nobody has planned.
void Gate::keep_in_lane(const std::string& id, const Visitor& guest) {
  const Place& place = guest.place;
  const bool enters = place.to_hold <= kInside;
  const bool is_planned = guest.passes && (enters || !guest.is_over);
  const bool is_too_late = place.to_hold >= 0.0 && !guest.can_stop;
  keeping_.keep(id, LaneKeeping::Reason::kGuest,
                place.leads_on ? !place.is_clear || is_planned : is_too_late);
}

void Gate::keep(const std::string& id) {
  const auto visitor = visitors_.find(id);
  if (visitor == visitors_.end()) return;
  visitor->second.seen = true;
  visitor->second.guest = false;
  visitor->second.place = {};
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
  visitor.passes = visitor.is_over = visitor.goes_on = false;
  visitor.line = visitor.place.line;
  visitor.held = true;
  traffic_.hold(id, true);
  keep_in_lane(id, visitor);
}

const Gate::Visitor* Gate::find(const std::string& id) const {
  const auto visitor = visitors_.find(id);
  return visitor != visitors_.end() ? &visitor->second : nullptr;
}

bool Gate::holds(const std::string& id) const {
  const Visitor* visitor = find(id);
  return visitor != nullptr && visitor->held;
}

bool Gate::passes(const std::string& id) const {
  const Visitor* visitor = find(id);
  return visitor != nullptr && visitor->passes;
}

bool Gate::holds_guest(const std::string& id) const {
  const Visitor* visitor = find(id);
  return visitor != nullptr && visitor->guest && visitor->held;
}

bool Gate::is_under_way(const std::string& id) const {
  const Visitor* visitor = find(id);
  return visitor != nullptr && visitor->guest && visitor->stands == 0;
}

/// Of two who go on over several junctions, and would meet, the one is held that was let through
/// later, if it still can be, and the other one need not pass there.
void Gate::hold_who_would_meet(const Surroundings& surroundings) {
  std::vector<const Entry*> passing;
  for (const Entry& entry : visitors_) {
    if (entry.second.passes) passing.push_back(&entry);
  }
  std::ranges::stable_sort(
      passing, {}, [](const Entry* e) { return std::pair(e->second.goes_on, e->second.since); });
  for (auto later = passing.begin(); later != passing.end(); ++later) {
    const auto& [id, visitor] = **later;
    const bool has_to_wait =
        visitor.goes_on && std::any_of(passing.begin(), later, [&](const Entry* other) {
          return other->second.passes &&
                 surroundings.may_meet({.id = id,
                                        .other = other->first,
                                        .from_one_lane = visitor.lane == other->second.lane}) &&
                 !surroundings.blocks(id, visitor.place.to_hold, other->first);
        });
    if (has_to_wait) hold(id);
  }
}

std::vector<std::string> Gate::propose(const Surroundings& surroundings) {
  hold_who_would_meet(surroundings);
  std::vector<Entry*> waiting;
  std::vector<const Entry*> ahead;  // of those who wait
  for (Entry& entry : visitors_) {
    Visitor& visitor = entry.second;
    const bool waits =
        visitor.guest && visitor.held && visitor.waits && surroundings.is_first(entry.first);
    if (waits) waiting.push_back(&entry);
    visitor.may_go = waits;
    if (!waits) visitor.passed_over = 0;
    if (visitor.passes || (!waits && !visitor.place.is_clear)) ahead.push_back(&entry);
  }
  // Who waits between two lines blocks those behind the first: he goes before them.
  std::ranges::stable_sort(waiting, {}, [](const Entry* e) {
    return std::pair(!e->second.place.is_between, e->second.asked);
  });
  std::vector<std::string> proposed;
  for (Entry* entry : waiting) {
    auto& [id, visitor] = *entry;
    const bool meets = std::ranges::any_of(ahead, [&](const Entry* other) {
      return !visitor.is_followed_by(other->second) &&
             surroundings.may_meet({.id = id,
                                    .other = other->first,
                                    .other_stays = !other->second.passes && !other->second.may_go,
                                    .from_one_lane = visitor.lane == other->second.lane});
    });
    const bool may_go = !meets && !surroundings.waits_for_people(id);
    if (meets) ++visitor.passed_over;
    if (may_go) {
      visitor.passed_over = 0;
      proposed.push_back(id);
    }
    const int due_after = visitor.place.is_between ? kDueBetween : kDueAfter;
    const bool is_due = visitor.passed_over > due_after;
    if (may_go || is_due) ahead.push_back(entry);
  }
  return proposed;
}

void Gate::asked_for(const std::string& id) {
  const auto visitor = visitors_.find(id);
  if (visitor != visitors_.end()) visitor->second.asked = decisions_;
}

void Gate::let_through(const std::string& id) {
  Visitor& visitor = visitors_.at(id);
  if (visitor.held) traffic_.hold(id, false);
  traffic_.let_through(id, passage_);
  visitor.held = false;
  visitor.passes = true;
  visitor.line = visitor.place.line;
  visitor.is_over = visitor.place.is_inside;
  visitor.since = decisions_;
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
