// Vehicles that ask for a path on a lot: who does, to which places, past whom.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include "coordinator/lot/lot_coordinator.hpp"
#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

constexpr double kRoomBesideSlot = 0.2;  ///< [m] on each side, for the doors of the others
constexpr double kOnExitLane = 1.5;      ///< [m] of exit lane behind a vehicle at its goal
constexpr double kManoeuvre = 10.0;      ///< [m] around a vehicle: free slots that help it out
constexpr double kBarWidth = 0.3;        ///< [m] of what closes a free slot, and
constexpr double kBarInset = 0.5;        ///< [m] by which it is shorter at both ends
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The rear axle of a body whose middle is at `middle`.
Pose axle_of(const Vehicle& body, const Pose& middle) {
  return compose(middle, {-(body.front - body.rear) / 2, 0.0, 0.0});
}

/// Where a vehicle that leaves is on its own again.
Pose exit_place(const Vehicle& body, const LotLane& lane) {
  return drive(lane.begin, Arc{body.rear + kOnExitLane, 0.0});
}

}  // namespace

void LotCoordinator::check_size(const std::string& id, const Vehicle& body) const {
  if (std::ranges::any_of(lot_.slots, [&](const ParkingSlot& s) { return fits(body, s); })) return;
  double length = 0.0;
  double width = 0.0;
  for (const ParkingSlot& slot : lot_.slots) {
    length = std::max(length, slot.length);
    width = std::max(width, slot.width);
  }
  throw InputError(
      "vehicle " + id,
      fmt::format("{:.2f} x {:.2f} m is too large for every slot of {} (up to {:.2f} x "
                  "{:.2f} m, {:.1f} m beside the vehicle); enlarge a <space> or route "
                  "it elsewhere",
                  body.length(), body.width, lot_.id, length, width, kRoomBesideSlot));
}

bool LotCoordinator::wants_a_path(const std::string& id, const Guest& guest) const {
  switch (guest.phase) {
    case Phase::kAtGate:
      return guest.entry >= 0;
    case Phase::kParked:
      return guest.wants_out && guest.taken_over && traffic_.can_move(id);
    case Phase::kStoppedPermanently:
      return !events_.at(id).broken;
    case Phase::kUnderWay:
      return false;
  }
  return false;
}

std::vector<std::string> LotCoordinator::those_who_ask() const {
  std::vector<std::pair<std::pair<std::int64_t, std::int64_t>, std::string>> order;
  for (const auto& [id, guest] : guests_) {
    if (wants_a_path(id, guest) && decisions_ >= guest.next_try)
      order.push_back({{guest.asked, guest.key}, id});
  }
  std::ranges::sort(order);
  std::vector<std::string> ids;
  for (auto& [rank, id] : order) ids.push_back(std::move(id));
  return ids;
}

/// Those who stand on the lot and ask for a path (true), or do not.
std::vector<StandingCar> LotCoordinator::standing(bool asking, const std::string& except) const {
  std::vector<StandingCar> result;
  for (const auto& [id, guest] : guests_) {
    const bool stands = guest.phase == Phase::kParked || guest.phase == Phase::kStoppedPermanently;
    if (!stands || id == except || wants_a_path(id, guest) != asking) continue;
    result.push_back({guest.pose, guest.body});
  }
  return result;
}

/// Those who stand and must not be touched beside what is solid: who asks for a path; where nobody
/// has a plan, which would keep off them, all.
std::vector<StandingCar> LotCoordinator::in_place(const std::string& except) const {
  std::vector<StandingCar> result = standing(true, except);
  if (options_.controller == LotController::kPbcr) {
    std::ranges::copy(standing(false, except), std::back_inserter(result));
  }
  return result;
}

/// All that the planner takes for solid: who stands and does not ask, and free slots but those
/// given by a bar along their middle, so that nobody drives through rows of slots. Where no plan
/// says who passes first, also who stands and asks, and where others will stand.
std::vector<StandingCar> LotCoordinator::solid(std::span<const int> free_to_use,
                                               const std::string& except) const {
  std::vector<StandingCar> result = standing(false, "");
  if (options_.controller == LotController::kPbcr) {
    std::ranges::copy(standing(true, except), std::back_inserter(result));
    for (const LotCar& car : motion_.cars()) {
      if (!car.leaves) result.push_back({car.goal, car.body});
    }
  }
  std::vector<bool> open(lot_.slots.size(), false);
  for (const int slot : free_to_use) open[std::size_t(slot)] = true;
  for (const auto& [id, guest] : guests_) {
    if (guest.slot >= 0) open[std::size_t(guest.slot)] = true;
  }
  for (std::size_t s = 0; s < lot_.slots.size(); ++s) {
    if (open[s]) continue;
    const double half = lot_.slots[s].length / 2 - kBarInset;
    result.push_back({lot_.slots[s].middle, {.front = half, .rear = half, .width = kBarWidth}});
  }
  return result;
}

bool LotCoordinator::fits(const Vehicle& body, const ParkingSlot& slot) const {
  constexpr double kRounding = 1e-6;
  return body.length() <= slot.length + kRounding &&
         body.width + 2 * kRoomBesideSlot <= slot.width + kRounding;
}

std::vector<Pose> LotCoordinator::places(const Vehicle& body, const ParkingSlot& slot) const {
  std::vector<Pose> result;
  Pose reversed = slot.middle;
  reversed.theta = wrap_to_pi(reversed.theta + std::numbers::pi);
  if (options_.parking != ParkingDirection::kReverse) result.push_back(axle_of(body, slot.middle));
  if (options_.parking != ParkingDirection::kForward) result.push_back(axle_of(body, reversed));
  return result;
}

std::vector<int> LotCoordinator::slots_for(const Guest& guest) {
  std::vector<bool> taken(lot_.slots.size(), false);
  for (const auto& [id, other] : guests_) {
    if (other.slot >= 0 && other.key != guest.key) taken[std::size_t(other.slot)] = true;
  }
  std::vector<SlotOffer> offers;
  for (std::size_t s = 0; s < lot_.slots.size(); ++s) {
    if (taken[s] || !fits(guest.body, lot_.slots[s])) continue;
    SlotOffer offer{s, kInfinity};
    for (const Pose& place : places(guest.body, lot_.slots[s])) {
      offer.distance = std::min(offer.distance, planner_.distance(guest.body, guest.pose, place));
    }
    offers.push_back(offer);
  }
  std::ranges::stable_sort(offers, {}, &SlotOffer::distance);
  if (options_.policy) options_.policy(offers);
  // Who found no path to the first ones tries the next ones.
  std::vector<int> slots;
  const std::size_t count = std::min(offers.size(), std::size_t(options_.slots_tried));
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t first = std::size_t(guest.failures) * count;
    slots.push_back(int(offers[(first + k) % offers.size()].slot));
  }
  return slots;
}

/// Between long cars a slot may be too tight to get out of, but for a free one across the aisle.
std::vector<int> LotCoordinator::slots_around(const Guest& guest) const {
  std::vector<int> slots;
  for (std::size_t s = 0; s < lot_.slots.size(); ++s) {
    if (distance(guest.pose, lot_.slots[s].middle) < kManoeuvre) slots.push_back(int(s));
  }
  return slots;
}

std::optional<LotAdmission> LotCoordinator::ask(const std::string& id, Guest& guest) {
  LotRequest request{.key = guest.key, .body = guest.body, .pose = guest.pose};
  std::vector<int> slots;  // of each goal; if it leaves, those that it may drive through
  request.leaves = guest.wants_out;
  if (guest.wants_out) {
    if (guest.failures > 0) slots = slots_around(guest);
    for (const LotLane& lane : lot_.exits) request.goals.push_back(exit_place(guest.body, lane));
  } else {
    for (const int s : slots_for(guest)) {
      for (const Pose& place : places(guest.body, lot_.slots[std::size_t(s)])) {
        request.goals.push_back(place);
        slots.push_back(s);
      }
    }
  }
  if (guest.phase == Phase::kAtGate) {
    request.entry = guest.entry;
    request.speed = guest.speed;
  }
  if (request.goals.empty()) {  // the lot is full: nothing was tried
    guest.failures = -1;
    return std::nullopt;
  }
  planner_.set_standing(solid(slots, id));
  const std::optional<LotAdmission> admission = planner_.admit(motion_, request, in_place(id));
  if (!admission) return admission;
  ParkingEvent& event = events_[id];
  if (guest.wants_out) {
    if (!event.admitted_out) event.alone_out = admission->alone;
    if (!event.admitted_out) event.admitted_out = traffic_.time();
  } else {
    guest.slot = slots[admission->goal];
    event.slot = lot_.slots[std::size_t(guest.slot)].id;
    if (!event.admitted_in) event.alone_in = admission->alone;
    if (!event.admitted_in) event.admitted_in = traffic_.time();
  }
  if (!guest.taken_over) {  // at the gate
    traffic_.hold(id, false);
    traffic_.cap_speed(id, kInfinity);
    take_over(id, guest);
  }
  guest.phase = Phase::kUnderWay;
  const LotCar& car = motion_.cars()[std::size_t(motion_.find(guest.key))];
  event.reversals += car.path.reversals();
  return admission;
}

}  // namespace mvtp
