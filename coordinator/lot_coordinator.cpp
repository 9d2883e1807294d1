#include "coordinator/lot_coordinator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

constexpr double kRoom = 2.0;              ///< [m] between the lot's frame and the ground
constexpr double kSameSlot = 1.5;          ///< [m] between a vehicle's middle and its slot's
constexpr double kInside = 0.2;            ///< [m] of ground behind a vehicle that is let in
constexpr double kBeforeLaneEnd = 0.5;     ///< [m]
constexpr double kStanding = 0.1;          ///< [m/s]
constexpr double kRoomBesideSlot = 0.2;    ///< [m] on each side, for the doors of the others
constexpr double kOnExitLane = 1.5;        ///< [m] of exit lane behind a vehicle at its goal
constexpr double kManoeuvre = 10.0;        ///< [m] around a vehicle: free slots that help it out
constexpr int kDecisionsAfterFailure = 2;  ///< PreCheck: who found no path does not ask sooner,
constexpr int kMostDoublings = 3;          ///< each time twice as late, at most so often
constexpr double kBarWidth = 0.3;          ///< [m] of what closes a free slot, and
constexpr double kBarInset = 0.5;          ///< [m] by which it is shorter at both ends
constexpr double kSettle = 5.0;            ///< [s]
constexpr double kGateGap = 1.0;           ///< [m] behind a vehicle that comes in, for the next,
constexpr double kGateBraking = 2.0;       ///< [m/s^2] of that
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Pose moved(const Pose& pose, const Point& by) { return {pose.x - by.x, pose.y - by.y, pose.theta}; }
Point moved(const Point& point, const Point& by) { return {point.x - by.x, point.y - by.y}; }

Point corner_of(const Polygon& ground) {
  Point low{kInfinity, kInfinity};
  for (const Point& p : ground) low = {std::min(low.x, p.x), std::min(low.y, p.y)};
  return {low.x - kRoom, low.y - kRoom};
}

ParkingLot moved(ParkingLot lot, const Point& by) {
  for (Point& p : lot.ground) p = moved(p, by);
  for (Polygon& polygon : lot.obstacles) {
    for (Point& p : polygon) p = moved(p, by);
  }
  for (ParkingSlot& slot : lot.slots) slot.middle = moved(slot.middle, by);
  for (LotLane& lane : lot.entries) lane.begin = moved(lane.begin, by);
  for (LotLane& lane : lot.exits) lane.begin = moved(lane.begin, by);
  for (Footpath& path : lot.footpaths) {
    for (Point& p : path.line) p = moved(p, by);
  }
  return lot;
}

/// The rear axle of a body whose middle is at `middle`.
Pose axle_of(const Vehicle& body, const Pose& middle) {
  return compose(middle, {-(body.front - body.rear) / 2, 0.0, 0.0});
}

/// Where a vehicle that leaves is on its own again.
Pose exit_place(const Vehicle& body, const LotLane& lane) {
  return drive(lane.begin, Arc{body.rear + kOnExitLane, 0.0});
}

LotPlannerOptions planner_options(const LotOptions& options) {
  LotPlannerOptions planner = options.planner;
  planner.regroup = options.controller == LotController::kEscot;
  return planner;
}

}  // namespace

LotCoordinator::LotCoordinator(Traffic& traffic, const ParkingLot& lot, const LotOptions& options)
    : traffic_(traffic),
      original_(lot),
      origin_(corner_of(lot.ground)),
      lot_(moved(lot, origin_)),
      options_(options),
      planner_(lot_, planner_options(options)),
      motion_(options.planner.limits) {
  steps_per_decision_ = std::max(1, int(std::lround(options.decision / traffic.step_length())));
}

Pose LotCoordinator::to_lot(const Pose& pose) const { return moved(pose, origin_); }
Pose LotCoordinator::from_lot(const Pose& pose) const {
  return {pose.x + origin_.x, pose.y + origin_.y, pose.theta};
}

bool LotCoordinator::drives(const std::string& id) const {
  const auto guest = guests_.find(id);
  return guest != guests_.end() && guest->second.taken_over;
}

bool LotCoordinator::rests(const std::string& id) const {
  const auto guest = guests_.find(id);
  return guest != guests_.end() && guest->second.phase == Phase::kParked &&
         !guest->second.wants_out;
}

Occupied LotCoordinator::occupied(double time) const {
  Occupied result{.time = time};
  for (const auto& [id, guest] : guests_) {
    result.parked += guest.phase == Phase::kParked ? 1 : 0;
    result.under_way += guest.phase == Phase::kUnderWay ? 1 : 0;
    result.at_gate += guest.phase == Phase::kAtGate && guest.held ? 1 : 0;
  }
  return result;
}

std::vector<LotSighting> LotCoordinator::sightings(Phase phase) const {
  std::vector<LotSighting> result;
  for (const auto& [id, guest] : guests_) {
    if (guest.phase != phase) continue;
    result.push_back({id, guest.body, from_lot(guest.pose), guest.wants_out});
  }
  return result;
}

std::vector<LotSighting> LotCoordinator::under_way() const { return sightings(Phase::kUnderWay); }
std::vector<LotSighting> LotCoordinator::parked() const { return sightings(Phase::kParked); }

const VehicleType& LotCoordinator::type_of(const std::string& id) {
  const auto known = types_.find(id);
  return known != types_.end() ? known->second
                               : types_.emplace(id, traffic_.type(id)).first->second;
}

void LotCoordinator::decide() {
  welcome();
  watch_the_gates();
  if (step_ % steps_per_decision_ == 0) replan();
  advance();
}

void LotCoordinator::act() {
  place_all();
  ++step_;
}

/// Those who come for the first time, and mean to park here.
void LotCoordinator::welcome() {
  for (const VehicleState& v : traffic_.vehicles()) {
    if (!seen_.insert(v.id).second) continue;
    const std::optional<ParkingStop> stop = traffic_.parking_stop(v.id);
    if (!stop || stop->area != lot_.id) continue;
    Guest guest;
    guest.key = next_key_++;
    guest.body = type_of(v.type).body;
    guest.pose = to_lot(v.pose);
    guest.stay = stop->duration;
    guest.until = stop->until;
    check_size(v.id, guest.body);
    ids_[guest.key] = v.id;
    visits_[v.id].id = v.id;
    if (stop->parked) adopt_parked(v.id, guest);
    guests_.emplace(v.id, guest);
  }
}

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

void LotCoordinator::adopt_parked(const std::string& id, Guest& guest) {
  guest.phase = Phase::kParked;
  guest.until = std::max(guest.until, traffic_.time() + guest.stay);
  visits_[id].parked = traffic_.time();
  visits_[id].there_at_start = true;
  const Pose middle = compose(guest.pose, {(guest.body.front - guest.body.rear) / 2, 0.0, 0.0});
  double nearest = kSameSlot;
  for (std::size_t s = 0; s < lot_.slots.size(); ++s) {
    const double away = distance(middle, lot_.slots[s].middle);
    if (away >= nearest) continue;
    nearest = away;
    guest.slot = int(s);
    visits_[id].slot = lot_.slots[s].id;
  }
}

/// Where those are who wait in the entry lanes; the front one of each may ask to be let in.
void LotCoordinator::watch_the_gates() {
  std::vector<const VehicleState*> front(lot_.entries.size(), nullptr);
  for (const VehicleState& v : traffic_.vehicles()) {
    const auto known = guests_.find(v.id);
    if (known == guests_.end() || known->second.phase != Phase::kAtGate) continue;
    Guest& guest = known->second;
    guest.entry = -1;
    if (traffic_.is_taken_over(v.id)) continue;  // another controller still drives it
    for (std::size_t e = 0; e < lot_.entries.size(); ++e) {
      if (lot_.entries[e].lane != v.lane) continue;
      if (!guest.held) {
        traffic_.drop_parking_stop(v.id);
        traffic_.hold(v.id, true);
        guest.held = true;
      }
      guest.pose = to_lot(v.pose);
      guest.speed = v.speed < kStanding ? 0.0 : v.speed;
      if (!front[e] || v.lane_position > front[e]->lane_position) front[e] = &v;
    }
  }
  for (std::size_t e = 0; e < front.size(); ++e) {
    if (!front[e]) continue;
    Guest& guest = guests_.at(front[e]->id);
    const LotLane& lane = lot_.entries[e];
    traffic_.cap_speed(front[e]->id, speed_behind_the_last(lane, guest));
    const double behind = front[e]->lane_position - guest.body.length() - lane.offset;
    if (behind < kInside) continue;
    const double room = lane.offset + lane.length - front[e]->lane_position - kBeforeLaneEnd;
    if (guest.speed > 0.0 && planner_.prefix_length(guest.speed) > room) continue;
    guest.entry = int(e);
    ParkingEvent& visit = visits_[front[e]->id];
    if (!visit.asked_in) visit.asked_in = traffic_.time();
  }
}

/// A car that comes in leaves its lane front first, and its driver's follower no longer sees it.
double LotCoordinator::speed_behind_the_last(const LotLane& lane, const Guest& guest) const {
  double free = kInfinity;  // [m] of lane
  for (const auto& [id, other] : guests_) {
    if (other.phase != Phase::kUnderWay && other.phase != Phase::kStranded) continue;
    const BoxPose box = box_pose(other.body, relative(lane.begin, other.pose));
    const double half_length = other.body.length() / 2;
    const double half_width = other.body.width / 2;
    const double reach_x = std::abs(box.ux) * half_length + std::abs(box.uy) * half_width;
    const double reach_y = std::abs(box.uy) * half_length + std::abs(box.ux) * half_width;
    const bool aside = std::abs(box.y) > reach_y + guest.body.width / 2;
    if (aside || box.x - reach_x > lane.length + kGateGap) continue;
    free = std::min(free, box.x - reach_x);
  }
  const double front = relative(lane.begin, guest.pose).x + guest.body.front;
  return std::sqrt(2 * kGateBraking * std::max(0.0, free - front - kGateGap));
}

/// Cars parked at the start keep their places in the traffic's own books until all are there.
void LotCoordinator::take_over_the_parked() {
  for (auto& [id, guest] : guests_) {
    if (guest.phase != Phase::kParked || guest.taken_over) continue;
    const bool settled = traffic_.time() > *visits_[id].parked + kSettle;
    if (!settled && traffic_.time() < guest.until - kSettle / 2) continue;
    traffic_.drop_parking_stop(id);
    take_over(id, guest);
  }
}

void LotCoordinator::end_stays() {
  for (auto& [id, guest] : guests_) {
    if (guest.phase != Phase::kParked || guest.wants_out) continue;
    if (traffic_.time() < guest.until || lot_.exits.empty()) continue;
    guest.wants_out = true;
    visits_[id].wished_out = traffic_.time();
  }
}

void LotCoordinator::break_down() {
  for (const auto& [id, time] : options_.breakdowns) {
    const auto guest = guests_.find(id);
    if (traffic_.time() < time || guest == guests_.end() || visits_[id].broken) continue;
    if (motion_.find(guest->second.key) < 0) continue;
    motion_.strand(guest->second.key);
    visits_[id].broken = true;
    for (const std::int64_t key : motion_.strand_the_blocked())
      visits_[ids_.at(key)].stranded = true;
  }
}

void LotCoordinator::take_over(const std::string& id, Guest& guest) {
  traffic_.take_over(id);
  traffic_.leave_road(id);
  guest.taken_over = true;
}

bool LotCoordinator::wants_a_way(const std::string& id, const Guest& guest) const {
  switch (guest.phase) {
    case Phase::kAtGate:
      return guest.entry >= 0;
    case Phase::kParked:
      return guest.wants_out && guest.taken_over && traffic_.can_move(id);
    case Phase::kStranded:
      return !visits_.at(id).broken;
    case Phase::kUnderWay:
      return false;
  }
  return false;
}

std::vector<std::string> LotCoordinator::those_who_ask() const {
  std::vector<std::pair<std::pair<std::int64_t, std::int64_t>, std::string>> order;
  for (const auto& [id, guest] : guests_) {
    if (wants_a_way(id, guest) && decisions_ >= guest.next_try)
      order.push_back({{guest.asked, guest.key}, id});
  }
  std::ranges::sort(order);
  std::vector<std::string> ids;
  for (auto& [rank, id] : order) ids.push_back(std::move(id));
  return ids;
}

/// Those who stand on the lot and ask for a way (true), or do not.
std::vector<StandingCar> LotCoordinator::standing(bool asking, const std::string& except) const {
  std::vector<StandingCar> result;
  for (const auto& [id, guest] : guests_) {
    const bool stands = guest.phase == Phase::kParked || guest.phase == Phase::kStranded;
    if (!stands || id == except || wants_a_way(id, guest) != asking) continue;
    result.push_back({guest.pose, guest.body});
  }
  return result;
}

/// All that the planner takes for solid: who stands and does not ask, and free slots but those
/// given by a bar along their middle, so that nobody drives through rows of slots.
std::vector<StandingCar> LotCoordinator::solid(std::span<const int> free_to_use) const {
  std::vector<StandingCar> result = standing(false, "");
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

void LotCoordinator::replan() {
  ++decisions_;
  take_over_the_parked();
  end_stays();
  break_down();
  const std::vector<std::string> asking = those_who_ask();
  const bool alone = options_.controller == LotController::kOneAtATime;
  if (motion_.cars().empty() && asking.empty()) return;
  const auto begin = std::chrono::steady_clock::now();
  Replan record{.time = traffic_.time(), .newcomers = 0};
  int tries = options_.tries;
  for (const std::string& id : asking) {
    if (tries == 0 || (alone && !motion_.cars().empty())) break;
    Guest& guest = guests_.at(id);
    guest.asked = decisions_;
    const std::optional<LotAdmission> admission = ask(id, guest);
    guest.failures = admission ? 0 : guest.failures + 1;
    const int patience = kDecisionsAfterFailure << std::min(guest.failures, kMostDoublings);
    guest.next_try = decisions_ + (admission ? 0 : patience);
    if (admission) {
      ++record.newcomers;
      record.groups += admission->replanned > 0 ? 1 : 0;
    }
    --tries;
  }
  planner_.set_standing(solid({}));
  record.groups += planner_.improve(motion_, standing(true, "")) > 0 ? 1 : 0;
  record.vehicles = int(motion_.cars().size());
  record.ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  replans_.push_back(record);
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
  // Who found no way to the first ones tries the next ones.
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
  planner_.set_standing(solid(slots));
  const std::optional<LotAdmission> admission =
      planner_.admit(motion_, request, standing(true, id));
  if (!admission) return admission;
  ParkingEvent& visit = visits_[id];
  if (guest.wants_out) {
    if (!visit.admitted_out) visit.alone_out = admission->alone;
    if (!visit.admitted_out) visit.admitted_out = traffic_.time();
  } else {
    guest.slot = slots[admission->goal];
    visit.slot = lot_.slots[std::size_t(guest.slot)].id;
    if (!visit.admitted_in) visit.alone_in = admission->alone;
    if (!visit.admitted_in) visit.admitted_in = traffic_.time();
  }
  if (!guest.taken_over) {  // at the gate
    traffic_.hold(id, false);
    traffic_.cap_speed(id, kInfinity);
    take_over(id, guest);
  }
  guest.phase = Phase::kUnderWay;
  const LotCar& car = motion_.cars()[std::size_t(motion_.find(guest.key))];
  visit.reversals += car.path.reversals();
  return admission;
}

std::vector<double> LotCoordinator::halts() {
  std::vector<Pedestrian> people(traffic_.pedestrians().begin(), traffic_.pedestrians().end());
  for (Pedestrian& person : people) person.position = moved(person.position, origin_);
  std::vector<StandingCar> strangers;
  for (const VehicleState& v : traffic_.vehicles()) {
    const bool leaving =
        std::ranges::any_of(lot_.exits, [&](const LotLane& lane) { return lane.lane == v.lane; });
    if (leaving && !drives(v.id)) strangers.push_back({to_lot(v.pose), type_of(v.type).body});
  }
  const std::vector<double> turns = motion_.turns();
  std::vector<double> result;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    result.push_back(LotLookout::halt(motion_, motion_.cars()[i], turns[i], {people, strangers}));
  }
  return result;
}

void LotCoordinator::advance() {
  std::vector<double> before;
  for (const LotCar& car : motion_.cars()) before.push_back(car.s);
  motion_.step(traffic_.step_length(), halts());
  for (std::size_t i = 0; i < motion_.cars().size(); ++i) {
    const LotCar& car = motion_.cars()[i];
    ParkingEvent& visit = visits_[ids_.at(car.key)];
    visit.distance += car.s - before[i];
    leave_slot(guests_.at(ids_.at(car.key)), car);
    if (car.v <= kStanding) visit.waited += traffic_.step_length();
  }
}

/// A slot is free again once the vehicle has got out of it.
void LotCoordinator::leave_slot(Guest& guest, const LotCar& car) const {
  if (!guest.wants_out || guest.slot < 0) return;
  const ParkingSlot& slot = lot_.slots[std::size_t(guest.slot)];
  if (distance(car.pose(), slot.middle) > slot.length + car.body.length() / 2) guest.slot = -1;
}

void LotCoordinator::place_all() {
  for (const LotCar& car : motion_.cars()) {
    const std::string& id = ids_.at(car.key);
    guests_.at(id).pose = car.pose();
    traffic_.place(id, from_lot(car.pose()), car.v);
    if (car.stops() || car.s < car.path.length() - LotPlanner::kRunOut) continue;
    traffic_.enter_road(id, exit_at(car.goal));
  }
  for (const auto& [id, guest] : guests_) {
    if (!guest.taken_over || guest.phase == Phase::kUnderWay) continue;
    traffic_.place(id, from_lot(guest.pose), 0.0);
  }
}

/// The exit lane in which a vehicle has its goal.
const std::string& LotCoordinator::exit_at(const Pose& goal) const {
  const auto away = [&](const LotLane& lane) {
    const Pose local = relative(lane.begin, goal);
    return std::abs(local.y) + std::max({0.0, -local.x, local.x - lane.length});
  };
  return std::ranges::min_element(lot_.exits, {}, away)->lane;
}

void LotCoordinator::arrive() {
  std::vector<std::int64_t> finished;
  for (const LotCar& car : motion_.cars()) {
    if (car.at_end()) finished.push_back(car.key);
  }
  for (const std::int64_t key : finished) {
    const std::string id = ids_.at(key);
    const LotCar& car = motion_.cars()[std::size_t(motion_.find(key))];
    Guest& guest = guests_.at(id);
    ParkingEvent& visit = visits_[id];
    const bool leaves = !car.stops();
    guest.phase = car.stranded ? Phase::kStranded : Phase::kParked;
    motion_.remove(key);
    if (leaves) {
      visit.handed_back = traffic_.time();
      traffic_.hand_back(id);
      guests_.erase(id);
    } else if (guest.phase == Phase::kParked) {
      visit.parked = traffic_.time();
      guest.until = std::max(guest.until, traffic_.time() + guest.stay);
    }
  }
}

}  // namespace mvtp
