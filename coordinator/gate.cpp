#include "coordinator/gate.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "planner/motion/inertial_car.hpp"

namespace mvtp {
namespace {

constexpr double kNear = 12.0;   ///< [m] before its line a vehicle waits for its turn,
constexpr double kCrawl = 5.0;   ///< [m/s] at no more than this;
constexpr double kStands = 0.5;  ///< [m/s] or it stands where it was held
constexpr double kApart = 50.0;  ///< [m] to the next line: there it is held again
constexpr double kSpare = 6.0;   ///< [m] beside its braking distance that a driver needs to stop

}  // namespace

void Gate::begin() {
  ++decisions_;
  for (auto& [id, guest] : guests_) guest.seen = false;
}

void Gate::see(const VehicleState& v, double to_line, double to_hold, const Vehicle& body) {
  const auto [entry, is_new] = guests_.try_emplace(v.id);
  Guest& guest = entry->second;
  guest.seen = true;
  guest.waits = (to_line < kNear && v.speed < kCrawl) || v.speed < kStands;
  const double room = stopping_distance(v.speed, 0.8 * body.max_decel) + kSpare;
  const bool anew = guest.passes && to_line > std::max(kApart, room);
  if (!is_new && !anew) return;
  if (anew) {
    traffic_.let_through(v.id, false);
    guest.passes = false;
  }
  if (to_hold > room) {
    traffic_.hold(v.id, true);
    guest.held = true;
  } else {
    let_through(v.id);
  }
}

void Gate::end() {
  std::vector<std::string> gone;
  for (const auto& [id, guest] : guests_) {
    if (!guest.seen) gone.push_back(id);
  }
  for (const std::string& id : gone) release(id);
}

bool Gate::passes(const std::string& id) const {
  const auto guest = guests_.find(id);
  return guest != guests_.end() && guest->second.passes;
}

std::optional<std::string> Gate::propose() {
  Guest* next = nullptr;
  std::optional<std::string> id;
  for (auto& [name, guest] : guests_) {
    if (!guest.held || !guest.waits) continue;
    if (next != nullptr && guest.asked >= next->asked) continue;
    next = &guest;
    id = name;
  }
  if (next != nullptr) next->asked = decisions_;
  return id;
}

void Gate::let_through(const std::string& id) {
  Guest& guest = guests_.at(id);
  if (guest.held) traffic_.hold(id, false);
  traffic_.let_through(id, true);
  guest.held = false;
  guest.passes = true;
}

void Gate::release(const std::string& id) {
  const auto guest = guests_.find(id);
  if (guest == guests_.end()) return;
  if (guest->second.held) traffic_.hold(id, false);
  if (guest->second.passes) traffic_.let_through(id, false);
  guests_.erase(guest);
}

}  // namespace mvtp
